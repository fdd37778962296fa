//! How a motion command begins.

use rcs_core::{Actions, Plain, Variables, decision_table};

/// Where the robot is when the command comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Robot {
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
    /// It does not.
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
pub struct Start {
    /// Where the robot is.
    pub robot: Robot,
    /// The goal.
    pub goal: GoalOf,
    /// The way.
    pub back: WayBack,
    /// Its leg.
    pub leg: LegNow,
}

/// How a motion command begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Beginning {
    /// Depart from the place where the robot is.
    Depart,
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
    /// RESUME: from where a motion command begins (docs/design/recovery.md "On the way"). Planning consults
    /// it when a motion command comes; no header names its rows.
    pub RESUME: fn resume(self::Start) -> self::Beginning {
        1: robot: AtPlace                                          => Depart;
        2: robot: Lost                                             => RefuseStart;
        3: robot: OnWay, goal: Way                                 => GoOn;
        4: robot: OnWay, goal: Another, leg: Depart                => GoOut;
        5: robot: OnWay, goal: Another, leg: Later, back: Free     => GoBack;
        6: robot: OnWay, goal: Another, leg: Later, back: Closed   => RefuseBack;
    }
}
