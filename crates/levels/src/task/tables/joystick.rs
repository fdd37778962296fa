use rcs_core::decision_table;

decision_table! {
    /// JOYSTICK (V.4.1 PAUSE): when the box becomes active, Task sends a pause down, even if no command is executing.
    /// An interrupted command is not resumed. A finished command is no longer reported, since the operator may undo
    /// it.
    pub JOYSTICK: fn joystick(enum Control, super::TaskOperator) -> super::Takeover or super::Takeover {
        /// Commands control the robot.
        Automatic {
            1: subtask: Pending | Executing | Done | Error | Lost   => consult(None);
            2: subtask: Joystick, outcome: Executing                => Interrupt  -> Manual;
            3: subtask: Joystick, outcome: Done                     => Clear      -> Manual;
            4: subtask: Joystick, outcome: Idle | Error | Joystick  => Pause      -> Manual;
        }
        /// The operator controls the robot with the joystick box.
        Manual {
            5: subtask: Pending | Executing | Joystick              => Refuse;
            6: subtask: Done | Error | Lost                         => Resume     -> Automatic;
        }
    }
}
