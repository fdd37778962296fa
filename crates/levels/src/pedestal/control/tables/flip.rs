use rcs_core::decision_table;

decision_table! {
    /// FLIP (VI.7.1): turn the table by the relative `table-angle`; no command to the hand.
    pub FLIP: fn flip(enum FlipStep, super::Situation) -> super::Action {
        /// No command sent yet.
        Start {
            1: otherwise  => Turn  -> Turning;
        }
        /// The table turns.
        Turning {
            2: otherwise  => Finish;
        }
    }
}
