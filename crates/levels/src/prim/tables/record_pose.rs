//! The record button of the joystick box: the table of every tick, whatever the command.

use rcs_core::{Plain, old_table};

use super::Posture;

/// Push-button X.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Button {
    /// Not pressed, or held down since an earlier tick.
    Idle,
    /// Pressed in this tick.
    Pressed,
}

/// A pose was recorded, and Prim and E-move wait for the operator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Recording {
    /// No.
    Off,
    /// Yes.
    On,
}

/// What happens to the record of the recorded pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Note {
    /// It stays as it is.
    Keep,
    /// The commanded pose is put into it.
    Record,
}

old_table! {
    /// RECORD-POSE (III.3.3): record the pose, and suspend Prim and E-move until the operator goes on. A
    /// Prim that is stepped is not suspended any more.
    pub RECORD_POSE: fn record_pose(button: Button, posture: Posture) -> (Note, Recording) {
        //   button    posture                        note     recording
        1: ( Pressed , Moving | Ending | Standing ) => Record , On  ;
        2: ( Pressed , Unpositioned               ) => Keep   , Off ;
        3: ( Idle    , _                          ) => Keep   , Off ;
    }
}
