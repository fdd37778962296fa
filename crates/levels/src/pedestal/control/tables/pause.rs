use rcs_core::decision_table;

decision_table! {
    /// PAUSE (VI.7.1): do nothing. A turning table stops. The hand finishes its command, since half a grasp holds
    /// nothing, and PAUSE waits for it. A failure of the hand does not fail PAUSE.
    pub PAUSE: fn pause(enum PauseStep, super::Situation) -> super::Action {
        /// No command sent yet.
        Start {
            1: otherwise      => StopTable  -> Stopping;
        }
        /// Table and hand come to rest.
        Stopping {
            2: fingers: Busy  => Wait;
            3: fingers: Over  => Finish;
        }
    }
}
