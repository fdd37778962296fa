//! Result of the last order of a command.

use rcs_core::decision_table;

decision_table! {
    /// ORDERED: Subtask or the Data System is busy with the last order, or it is done. A failure ends the
    /// command, and so does the operator who takes the robot. The Data System is asked again if it is late.
    pub ORDERED: fn ordered(super::Subordinates) -> super::Action or crate::execution::Work {
        1:  takeover: Interrupt                                    => PassUp;
        2:  ordered: Nothing                                       => consult(Over);
        3:  ordered: Subtask,    subtask: Pending | Executing      => consult(Busy);
        4:  ordered: Subtask,    subtask: Done                     => consult(Over);
        5:  ordered: Subtask,    subtask: Error | Joystick | Lost  => PassUp;
        6:  ordered: DataSystem, data_base: Executing              => consult(Busy);
        7:  ordered: DataSystem, data_base: Done                   => consult(Over);
        8:  ordered: DataSystem, data_base: Overdue                => SendAgain;
        9:  ordered: DataSystem, data_base: Refused                => Fail(DataBase);
        10: ordered: DataSystem, data_base: Silent                 => Fail(DataBaseSilent);
    }
}
