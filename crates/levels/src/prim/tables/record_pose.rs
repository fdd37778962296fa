//! The record button of the joystick box: the table of every tick, whatever the command.

use rcs_core::{coded_enum, decision_table};

use super::Posture;

coded_enum! {
    /// A pose was recorded, and Prim and E-move wait for the operator.
    pub enum Recording {
        /// No.
        Off = "off",
        /// Yes.
        On = "on",
    }
}

coded_enum! {
    /// What the operator has just done. Going on comes first.
    pub enum Wish {
        /// Nothing.
        None = "none",
        /// Pressed button X.
        Record = "record",
        /// Pressed carriage return at the terminal.
        Resume = "resume",
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
    /// RECORD-POSE (III.3.3): record the pose, and suspend Prim and E-move until the operator goes on.
    pub RECORD_POSE: fn record_pose(recording: Recording, wish: Wish, posture: Posture) -> (Note, Recording) {
        //   recording wish            posture                        note     recording
        1: ( Off     , Record        , Moving | Ending | Standing ) => Record , On  ;
        2: ( Off     , Record        , Unpositioned               ) => Keep   , Off ;
        3: ( Off     , None | Resume , _                          ) => Keep   , Off ;
        4: ( On      , None | Record , _                          ) => Keep   , On  ;
        5: ( On      , Resume        , _                          ) => Keep   , Off ;
    }
}
