//! PAUSE (VI.7.1).

use rcs_core::decision_table;

decision_table! {
    /// PAUSE (VI.7.1): do nothing. A turning table stops; the hand goes on to the end of what it was told,
    /// since half a grasp holds nothing, and is waited for. That it fails is no matter of PAUSE.
    pub PAUSE: fn pause(enum PauseStep, super::Situation) -> super::Action {
        /// Nothing sent yet.
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
