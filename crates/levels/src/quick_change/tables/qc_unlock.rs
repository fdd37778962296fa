//! QC-UNLOCK (VI.2.1).

use rcs_core::decision_table;

decision_table! {
    /// QC-UNLOCK (VI.2.1): unlock, and check that neither ring nor sensors fail. Done at once if it is
    /// unlocked. The id does not count: its contacts part while the gripper drops.
    pub QC_UNLOCK: fn qc_unlock(super::Step, super::Situation) -> super::Action or () {
        Start {
            1: ring: Unread                            => Wait;
            2: ring: Implausible                       => Fail(SensorMalfunction)  -> Faulty;
            3: ring: Unlocked                          => Report(Unlocked)         -> Watch;
            4: ring: Locked | Between, clock: Running  => Unlock;
            5: ring: Locked | Between, clock: Expired  => Fail(Stuck)              -> Stuck;
        }
        Watch | Stuck | Faulty {
            6: otherwise                               => consult;
        }
    }
}
