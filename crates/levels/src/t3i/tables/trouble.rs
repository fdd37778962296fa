//! Errors, common to all commands.

use rcs_core::decision_table;

decision_table! {
    /// TROUBLE: after a refusal or a failure of the link the last position is repeated, for every command. A robot
    /// that has left its path gets no position: its way there would be undefined.
    pub TROUBLE: fn trouble(super::Situation) -> super::Action or () {
        1: trouble: Refusal | Fault, line: Free         => Repeat(Error);
        2: trouble: Refusal | Fault, line: Busy | Down  => Nothing(Error);
        3: trouble: OffPath                             => Nothing(Error);
        4: trouble: None                                => consult;
    }
}
