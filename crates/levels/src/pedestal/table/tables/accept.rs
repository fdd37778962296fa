use rcs_core::decision_table;

decision_table! {
    /// ACCEPT: a turn beyond the limits is refused. A calibration in progress continues.
    pub ACCEPT: fn accept(super::Request) -> crate::execution::Refusal or () {
        1: asked: Before  => consult;
        2: verb: None     => Fail(UnknownCommand);
        3: angle: Beyond  => Fail(TableLimit);
        4: angle: Within  => consult;
    }
}
