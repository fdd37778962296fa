//! The record button of the joystick box: the table of every tick, whatever the command.

use rcs_core::{coded_enum, decision_table};

use super::Posture;

coded_enum! {
    /// Push-button X.
    pub enum Button {
        /// Not pressed, or held down since an earlier tick.
        Idle = "idle",
        /// Pressed in this tick.
        Pressed = "pressed",
    }
}

coded_enum! {
    /// A pose was recorded, and Prim and E-move wait for the operator.
    pub enum Recording {
        /// No.
        Off = "off",
        /// Yes.
        On = "on",
    }
}

/// What happens to the record of the recorded pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Note {
    /// It stays as it is.
    Keep,
    /// The commanded pose is put into it.
    Record,
}

decision_table! {
    /// RECORD-POSE (III.3.3): record the pose, and suspend Prim and E-move until the operator goes on. A
    /// Prim that is stepped is not suspended any more.
    pub RECORD_POSE: fn record_pose(button: Button, posture: Posture) -> (Note, Recording) {
        //   button    posture                        note     recording
        1: ( Pressed , Moving | Ending | Standing ) => Record , On  ;
        2: ( Pressed , Unpositioned               ) => Keep   , Off ;
        3: ( Idle    , _                          ) => Keep   , Off ;
    }
}
