use rcs_core::decision_table;

decision_table! {
    /// S-PAUSE (V.3.1): stop E-move with E-PAUSE, and a commanded pedestal with PAUSE.
    pub S_PAUSE: fn s_pause(enum SPauseStep, super::Situation) -> super::Action {
        any {
            1: work: Busy  => Wait;
        }
        /// Nothing done yet.
        Start {
            2: otherwise   => Pause  -> Pausing;
        }
        /// E-move is pausing.
        Pausing {
            3: otherwise   => Finish;
        }
    }
}
