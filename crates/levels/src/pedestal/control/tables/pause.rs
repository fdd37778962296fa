//! PAUSE (VI.7.1).

use rcs_core::decision_table;

decision_table! {
    /// PAUSE (VI.7.1): do nothing. A turning table stops; the hand goes on to the end of what it was told,
    /// since half a grasp holds nothing.
    pub PAUSE: fn pause(enum PauseStep, super::Situation) -> super::Action {
        /// Nothing sent yet.
        Start {
            1:                          => StopTable        -> Stopping;
        }
        /// The table stops.
        Stopping {
            2:                          => Finish;
        }
    }
}
