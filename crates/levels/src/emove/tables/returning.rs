//! Return of a robot that is neither at a known place nor on its way.

use rcs_core::{Actions, Plain, Variables, decision_table};

use super::Knowledge;
pub use interfaces::track::Course;

/// The start of the robot's recorded path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveOrigin {
    /// Unknown, or no path is recorded.
    None,
    /// A place.
    Place,
    /// The tool drum, with the fingers around a tool in it.
    Drum,
    /// The path of a motion that was interrupted.
    Way,
}

/// The object that the gripper has brought from the start of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum BroughtObject {
    /// No object that can be clamped.
    Free,
    /// A part that a vise or the pedestal may have clamped there.
    Clampable,
}

/// The known location that is nearest to the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Near {
    /// A location without a straight return, or one too far away.
    Nothing,
    /// A resting place, near enough for a straight return.
    Resting,
    /// Any location: the robot is off the approach of the nest that it has left, but within its outermost point.
    Nest,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Lost {
    /// Knowledge of the robot's frame, by the resolvers.
    pub resolvers: Knowledge,
    /// Knowledge of its path.
    pub course: Course,
    /// The start of its recorded path.
    pub origin: EmoveOrigin,
    /// The object that the gripper has brought from there.
    pub freight: BroughtObject,
    /// The nearest known location.
    pub near: Near,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Return {
    /// Back along the recorded path.
    Retrace,
    /// Straight to the resting place.
    Straight,
    /// Out of the nest against the direction of its approach, to its outermost point.
    Out,
    /// Refuse: only the joystick box can move the robot.
    Refuse,
}

decision_table! {
    /// RETURN: the return of a robot that is neither at a known place nor on its way (IV.3.3 step 19;
    /// docs/design/recovery.md "Return"). The controller knows no obstacles. Therefore the robot retraces the path
    /// recorded while the joystick box moved it, or moves along a short straight line that the task data allow.
    /// Planning consults this table for a new motion command. Headers do not name its rows.
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
