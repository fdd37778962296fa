//! QC-LOCK (VI.2.1).

use rcs_core::decision_table;

decision_table! {
    /// QC-LOCK (VI.2.1): lock, check that the ring did not get stuck, disable the control port. Done at once
    /// if it is locked.
    pub QC_LOCK: fn qc_lock(super::Step, super::Situation) -> super::Action or () {
        Start {
            1: ring: Unread                              => Wait;
            2: ring: Implausible                         => Fail(SensorMalfunction)  -> Faulty;
            3: ring: Locked,             id: Illegal     => Fail(SensorMalfunction)  -> Faulty;
            4: ring: Locked,             id: Legal       => Report(Locked)           -> Watch;
            5: ring: Unlocked | Between, clock: Running  => Lock;
            6: ring: Unlocked | Between, clock: Expired  => Fail(Stuck)              -> Stuck;
        }
        Watch | Stuck | Faulty {
            7: otherwise                                 => consult;
        }
    }
}
