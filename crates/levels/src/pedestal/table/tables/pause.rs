//! PAUSE.

use rcs_core::decision_table;

decision_table! {
    /// PAUSE: a turning table stops; one that does not answer is left alone.
    pub PAUSE: fn pause(super::Situation) -> super::Action {
        1: otherwise  => Finish;
    }
}
