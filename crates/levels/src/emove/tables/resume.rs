//! The start of a motion command.

use rcs_core::{Actions, Plain, Variables, decision_table};

/// The robot's place at the start of the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveRobot {
    /// At a known place.
    AtPlace,
    /// On the way of an interrupted motion.
    OnWay,
    /// At an unknown place.
    Lost,
}

/// The goal of the command, relative to the robot's way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum GoalOf {
    /// The goal of the way: same kind, place, object and grip, and within 0.02 in.
    Way,
    /// The robot's pose, or its pose before manual motion: same location, and within 0.02 in.
    Place,
    /// Another goal.
    Another,
}

/// The return along the robot's way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum ReturnPath {
    /// The robot can retrace the way to the end of the depart leg.
    Free,
    /// The way connects two poses at the same object, such as hold and seat: the robot can only continue.
    Closed,
}

/// The robot's leg on its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum CurrentLeg {
    /// The depart leg.
    Depart,
    /// A leg after it.
    Later,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct MotionStart {
    /// The robot's place.
    pub robot: EmoveRobot,
    /// The goal, relative to the way.
    pub goal: GoalOf,
    /// The return along the way.
    pub back: ReturnPath,
    /// The leg on the way.
    pub leg: CurrentLeg,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum MotionBeginning {
    /// Depart from the place where the robot is.
    Depart,
    /// The robot is at the goal, or near it: STANCE decides.
    Settle,
    /// Continue to the goal of the way.
    GoOn,
    /// Complete the depart leg, and move from its end to the goal.
    GoOut,
    /// Return to the end of the depart leg, and move from there to the goal.
    GoBack,
    /// Refuse: the robot can only continue its way.
    RefuseBack,
    /// Refuse: the robot's place is unknown.
    RefuseStart,
}

decision_table! {
    /// RESUME: the start of a motion command (docs/design/recovery.md "On the way"). A robot at an unknown place has
    /// first returned according to RETURN. Planning consults this table for a new motion command. Headers do not name
    /// its rows.
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

/// The present frame, relative to the robot's place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveOffset {
    /// At the place within 0.02 in and 0.1 degree. With a commanded part that may be clamped, within 0.1 in.
    There,
    /// Moved by the operator, by at most 0.5 in and 2 degrees.
    Moved,
    /// Moved by the operator in the same range, with a part that may be clamped.
    Clamped,
    /// Unknown: the resolvers give no position, and the robot was not sent there.
    Unseen,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct EmoveStanding {
    /// The present frame, relative to the robot's place.
    pub offset: EmoveOffset,
}

/// The action before a command that ends or works at the robot's place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Stance {
    /// None: the robot is at its place.
    Stay,
    /// Return to the place, straight and slowly.
    Correct,
    /// Refuse: the motion would pull the part through the fingers, or out of the vise.
    RefuseOff,
    /// Refuse: the robot's place is unknown.
    RefuseStart,
}

decision_table! {
    /// STANCE: a robot at its place, checked by the resolvers, before a command that ends there (MOV-…) or works
    /// there (LOCATE-OBJ, GRASP-OBJ, RELEASE). Planning consults this table for such a command. Headers do not name
    /// its rows.
    pub STANCE: fn stance(self::EmoveStanding) -> self::Stance {
        1: offset: There    => Stay;
        2: offset: Moved    => Correct;
        3: offset: Clamped  => RefuseOff;
        4: offset: Unseen   => RefuseStart;
    }
}
