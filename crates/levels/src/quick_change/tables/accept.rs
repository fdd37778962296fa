use rcs_core::decision_table;

decision_table! {
    /// ACCEPT: an unknown command is refused. The ring is still watched.
    pub ACCEPT: fn accept(super::Request) -> crate::execution::Refusal or () {
        1: asked: Before                => consult;
        2: verb: None                   => Fail(UnknownCommand);
        3: verb: Pause | Lock | Unlock  => consult;
    }
}
