use rcs_core::decision_table;

decision_table! {
    /// PAUSE (V.4.1): stop everything below with S-PAUSE.
    pub PAUSE: fn pause(enum PauseStep, super::Situation) -> super::Action {
        any {
            1: work: Busy  => Wait;
        }
        /// Nothing done yet.
        Start {
            2: otherwise   => Pause  -> Pausing;
        }
        /// Subtask is pausing.
        Pausing {
            3: otherwise   => Finish;
        }
    }
}
