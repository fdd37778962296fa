//! How a motion command begins.

use rcs_core::{Actions, Plain, Variables, decision_table};

/// Where the robot is when the command comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveRobot {
    /// At a known place.
    AtPlace,
    /// On the way of a motion that was interrupted.
    OnWay,
    /// Neither.
    Lost,
}

/// The goal of the command, seen from the way that the robot is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GoalOf {
    /// That way leads to it: same kind, place, object and grip, and within 0.02 in.
    Way,
    /// The pose at which the robot is, or was before a person moved it: same location, and within 0.02 in.
    Place,
    /// Neither.
    Another,
}

/// The way that the robot is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum WayBack {
    /// It can be flown back to the end of the depart leg.
    Free,
    /// It leads from one pose to another at the same object, as from hold to seat: only on.
    Closed,
}

/// The leg that the robot is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum LegNow {
    /// The depart leg.
    Depart,
    /// One after it.
    Later,
}

/// The state variables.
#[derive(Clone, Copy, Debug, Variables)]
pub struct MotionStart {
    /// Where the robot is.
    pub robot: EmoveRobot,
    /// The goal.
    pub goal: GoalOf,
    /// The way.
    pub back: WayBack,
    /// Its leg.
    pub leg: LegNow,
}

/// How a motion command begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum MotionBeginning {
    /// Depart from the place where the robot is.
    Depart,
    /// The robot is at the goal, or beside it: STANCE decides.
    Settle,
    /// Go on to the goal of the way.
    GoOn,
    /// Go out of the depart leg, and from its end to the goal.
    GoOut,
    /// Go back to the end of the depart leg, and from there to the goal.
    GoBack,
    /// Refuse: the robot can only go on.
    RefuseBack,
    /// Refuse: it is not known where the robot is.
    RefuseStart,
}

decision_table! {
    /// RESUME: from where a motion command begins (docs/design/recovery.md "On the way"). A robot that is lost has
    /// come back before, as RETURN says. Planning consults it when a motion command comes; no header names its rows.
    pub RESUME: fn resume(self::MotionStart) -> self::MotionBeginning {
        1: robot: AtPlace, goal: Way | Another                              => Depart;
        2: robot: AtPlace, goal: Place                                      => Settle;
        3: robot: Lost                                                      => RefuseStart;
        4: robot: OnWay,   goal: Way                                        => GoOn;
        5: robot: OnWay,   goal: Place | Another, leg: Depart               => GoOut;
        6: robot: OnWay,   goal: Place | Another, leg: Later, back: Free    => GoBack;
        7: robot: OnWay,   goal: Place | Another, leg: Later, back: Closed  => RefuseBack;
    }
}

/// The present frame, seen from the place of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveOffset {
    /// It is there: within 0.02 in and 0.1 degree. A robot that was sent there, and holds a part that may be clamped, is
    /// there within 0.1 in.
    There,
    /// A person has moved it, by no more than 0.5 in and 2 degrees.
    Moved,
    /// So has somebody, and what it holds may be clamped.
    Clamped,
    /// The resolvers do not tell, and it was not sent there.
    Unseen,
}

/// The state variables.
#[derive(Clone, Copy, Debug, Variables)]
pub struct EmoveStanding {
    /// Where the robot is.
    pub offset: EmoveOffset,
}

/// What precedes a command that ends at the place of the robot, or does its work there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Stance {
    /// Nothing: the robot is there.
    Stay,
    /// Go back to the place, straight and slowly.
    Correct,
    /// Refuse: the part would be pulled through the fingers, or out of the vise.
    RefuseOff,
    /// Refuse: it is not known where the robot is.
    RefuseStart,
}

decision_table! {
    /// STANCE: a robot at its place, seen by its resolvers, before a command that ends there (MOV-…) or does its work
    /// there (LOCATE-OBJ, GRASP-OBJ, RELEASE). Planning consults it when such a command comes; no header names its rows.
    pub STANCE: fn stance(self::EmoveStanding) -> self::Stance {
        1: offset: There    => Stay;
        2: offset: Moved    => Correct;
        3: offset: Clamped  => RefuseOff;
        4: offset: Unseen   => RefuseStart;
    }
}
