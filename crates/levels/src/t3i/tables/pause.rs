use rcs_core::decision_table;

decision_table! {
    /// PAUSE (VI.1.1): the last position is repeated, also before the first command.
    pub PAUSE: fn pause(enum PauseStep, super::Situation) -> super::Action {
        /// The position is repeated.
        Holding {
            1: line: Busy | Down  => Nothing(Executing);
            2: line: Free         => Repeat(Finished);
        }
    }
}
