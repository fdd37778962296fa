//! A process that was started in the middle of a job.

use rcs_core::decision_table;

decision_table! {
    /// RESTARTED: a table that turns by an order of the time before is stopped, once; the hand is left alone.
    pub RESTARTED: fn restarted(super::Remains) -> super::Action or () {
        1:  ordered: Nothing                => StopTable;
        2:  ordered: Hand | Table | Both    => consult;
    }
}
