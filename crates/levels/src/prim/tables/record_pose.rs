//! The record button of the joystick box: a table of every tick, for all commands.

use rcs_core::{Actions, Plain, decision_table};

/// What happens to the record of the recorded pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Recording {
    /// The record stays as it is.
    Keep,
    /// The record takes the commanded pose; Prim and E-move are suspended until the operator continues.
    Record,
}

decision_table! {
    /// RECORD-POSE (III.3.3): decides whether the commanded pose is recorded. A Prim that is stepped singly is not
    /// suspended again.
    pub RECORD_POSE: fn record_pose(super::Path) -> Recording {
        1: button: Idle                                          => Keep;
        2: button: Pressed, posture: Unpositioned                => Keep;
        3: button: Pressed, posture: Moving | Ending | Standing  => Record;
    }
}
