use rcs_core::decision_table;

decision_table! {
    /// RESTART (VI.1.1): start the link again and wait for the report.
    pub RESTART: fn restart(enum RestartStep, super::Situation) -> super::Action {
        /// Nothing sent yet.
        Start {
            1: otherwise   => Restart(Executing)  -> Restarting;
        }
        /// The restart is sent.
        Restarting {
            2: line: Down  => Nothing(Executing);
            3: line: Busy  => Nothing(Finished);
            4: line: Free  => Repeat(Finished);
        }
    }
}
