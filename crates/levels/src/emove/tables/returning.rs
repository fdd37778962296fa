//! Return of a robot that is neither at a known place nor on its way.

use rcs_core::{Actions, Plain, Variables, decision_table};

use super::Knowledge;
pub use interfaces::track::Course;

/// Where the record of its path leads back to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveOrigin {
    /// Nowhere: there is none, or it is not known where it begins.
    None,
    /// A place.
    Place,
    /// The tool drum, with the fingers around a tool in it.
    Drum,
    /// The path of a motion that was interrupted.
    Way,
}

/// What the gripper has brought away from there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Freight {
    /// Nothing that can be clamped.
    Free,
    /// A part that a vise or the pedestal may have clamped at that place.
    Clampable,
}

/// The known location that is nearest to the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Near {
    /// It is none to which the robot may go straight, or it is too far away.
    Nothing,
    /// It is a resting place, and near enough to go there straight.
    Resting,
    /// It does not matter: the robot is beside the path from the nest that it has left to the outermost point of the
    /// approach of that nest.
    Nest,
}

/// The state variables.
#[derive(Clone, Copy, Debug, Variables)]
pub struct Lost {
    /// Where the resolvers say that the robot is.
    pub resolvers: Knowledge,
    /// What is known of its path.
    pub course: Course,
    /// Where that begins.
    pub origin: EmoveOrigin,
    /// What it has brought away.
    pub freight: Freight,
    /// What is near.
    pub near: Near,
}

/// How it comes back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Return {
    /// Back along the recorded path.
    Retrace,
    /// Straight to the resting place.
    Straight,
    /// Out of the nest against the direction of its approach, to its outermost point.
    Out,
    /// Not at all: only the joystick box moves it.
    Refuse,
}

decision_table! {
    /// RETURN: how a robot comes back that is neither at a known place nor on its way (IV.3.3 step 19;
    /// docs/design/recovery.md "Return"). The controller knows no obstacles: the robot goes back on the path on which
    /// the joystick box has moved it, else on a short straight line that the task data allow. Planning consults it
    /// when a motion command comes; no header names its rows.
    pub RETURN: fn returning(self::Lost) -> self::Return {
        1: resolvers: Unknown                    => Refuse;
        2: course: Adrift                        => Refuse;
        3: origin: Drum                          => Refuse;
        4: freight: Clampable                    => Refuse;
        5: course: Tracked, origin: Place | Way  => Retrace;
        6: near: Resting                         => Straight;
        7: near: Nest                            => Out;
        8: near: Nothing                         => Refuse;
    }
}
