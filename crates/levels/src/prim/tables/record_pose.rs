//! The record button of the joystick box: a table of every tick, for all commands.

use rcs_core::{Actions, Plain, decision_table};

/// What happens to the record of the recorded pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Recording {
    /// It stays as it is.
    Keep,
    /// The commanded pose is put into it; Prim and E-move are suspended until the operator goes on.
    Record,
}

decision_table! {
    /// RECORD-POSE (III.3.3): is the commanded pose recorded? A Prim that is stepped is not suspended any
    /// more.
    pub RECORD_POSE: fn record_pose(super::Path) -> Recording {
        1: button: Idle                                          => Keep;
        2: button: Pressed, posture: Unpositioned                => Keep;
        3: button: Pressed, posture: Moving | Ending | Standing  => Record;
    }
}
