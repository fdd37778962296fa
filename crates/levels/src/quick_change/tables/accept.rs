//! Preconditions of a command.

use rcs_core::decision_table;

decision_table! {
    /// ACCEPT: a command that Quick Change does not have is refused. The ring is watched all the same.
    pub ACCEPT: fn accept(super::Request) -> crate::execution::Refusal or () {
        1: asked: Before                => consult;
        2: verb: None                   => Fail(UnknownCommand);
        3: verb: Pause | Lock | Unlock  => consult;
    }
}
