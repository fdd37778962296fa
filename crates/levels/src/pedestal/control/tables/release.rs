use rcs_core::decision_table;

decision_table! {
    /// RELEASE (VI.7.1): open the hand to `grasp-size`; no command to the table.
    pub RELEASE: fn release(enum ReleaseStep, super::Situation) -> super::Action {
        /// No command sent yet.
        Start {
            1: otherwise  => Open  -> Opening;
        }
        /// The hand opens.
        Opening {
            2: otherwise  => Finish;
        }
    }
}
