//! The joystick box (V.4.1 PAUSE): the table of every tick, for all commands.

use rcs_core::decision_table;

decision_table! {
    /// JOYSTICK (V.4.1 PAUSE): when the box becomes active, Task sends down a pause, also when no command is
    /// executing. What was interrupted is not resumed, and what was finished is reported no longer, since the
    /// operator may undo it.
    pub JOYSTICK: fn joystick(enum Control, super::TaskOperator) -> super::Takeover or super::Takeover {
        /// The commands have the robot.
        Automatic {
            1: subtask: Pending | Executing | Done | Error | Lost   => consult(None);
            2: subtask: Joystick, outcome: Executing                => Interrupt  -> Manual;
            3: subtask: Joystick, outcome: Done                     => Clear      -> Manual;
            4: subtask: Joystick, outcome: Idle | Error | Joystick  => Pause      -> Manual;
        }
        /// The operator has it, with the joystick box.
        Manual {
            5: subtask: Pending | Executing | Joystick              => Refuse;
            6: subtask: Done | Error | Lost                         => Resume     -> Automatic;
        }
    }
}
