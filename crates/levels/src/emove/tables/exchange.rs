//! What QC-ATTACH and QC-DETACH have in common.

use rcs_core::decision_table;

decision_table! {
    /// EXCHANGE: in the change of a gripper each move and each turn of the ring ends before the next one
    /// begins, and the sensors of the ring agree.
    pub EXCHANGE: fn exchange(struct of super::Senses) -> super::Action or () {
        1: work: Busy                                     => Wait;
        2: work: Over, lock: Faulty                       => FailRing;
        3: work: Over, lock: Locked | Unlocked | Between  => consult;
    }
}
