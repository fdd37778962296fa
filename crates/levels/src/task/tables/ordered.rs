use rcs_core::decision_table;

decision_table! {
    /// ORDERED: the result of the last order to Subtask or the Data System. A failure ends the command, and so does
    /// manual control. A command to a late Data System is retried.
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
