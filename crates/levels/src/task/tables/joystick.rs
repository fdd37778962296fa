//! The joystick box (V.4.1 PAUSE): the table of every tick, whatever the command.

use rcs_core::{handshake::Lower, old_table};

use crate::task::state::Watch;

/// What is done about the joystick box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Takeover {
    /// Nothing: the operator does not have the robot.
    None,
    /// The operator takes it: the command that was executing ends, S-PAUSE goes down.
    Yield,
    /// The operator has it: nothing but PAUSE is accepted.
    Refuse,
    /// The operator gives it back: the next command is awaited.
    Resume,
}

old_table! {
    /// JOYSTICK (V.4.1 PAUSE): when the box becomes active, Task sends down a pause, also when no command was
    /// running. What was interrupted is not resumed.
    pub JOYSTICK: fn joystick(watch: Watch, subtask: Lower) -> (Takeover, Watch) {
        //    watch    subtask                                    takeover  watch
        1: ( Free   , Pending | Executing | Done | Error | Lost ) => None   , Free   ;
        2: ( Free   , Joystick                                  ) => Yield  , Manual ;
        3: ( Manual , Pending | Executing | Joystick            ) => Refuse , Manual ;
        4: ( Manual , Done | Error | Lost                       ) => Resume , Free   ;
    }
}
