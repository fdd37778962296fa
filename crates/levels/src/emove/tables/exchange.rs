//! Common rows of QC-ATTACH and QC-DETACH.

use rcs_core::decision_table;

decision_table! {
    /// EXCHANGE: in a gripper exchange each move and each turn of the ring ends before the next one begins, and the
    /// sensors of the ring are consistent.
    pub EXCHANGE: fn exchange(struct of super::Senses) -> super::Action or () {
        1: work: Busy                                     => Wait;
        2: work: Over, lock: Faulty                       => FailRing;
        3: work: Over, lock: Locked | Unlocked | Between  => consult;
    }
}
