use rcs_core::decision_table;

decision_table! {
    /// SHUTDOWN (V.4.1): disconnect the Data System with an Abort. It is disconnected from the first tick, before its
    /// answer.
    pub SHUTDOWN: fn shutdown(enum ShutdownStep, super::Situation) -> super::Action {
        any {
            1: work: Busy  => Wait;
        }
        /// Nothing done yet.
        Start {
            2: otherwise   => Disconnect  -> Aborting;
        }
        /// Abort was sent.
        Aborting {
            3: otherwise   => Finish;
        }
    }
}
