use rcs_core::decision_table;

decision_table! {
    /// PAUSE: a turning table stops; a motor that does not answer gets no order.
    pub PAUSE: fn pause(super::Situation) -> super::Action {
        1: otherwise  => Finish;
    }
}
