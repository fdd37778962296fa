use rcs_core::decision_table;

decision_table! {
    /// QC-UNLOCK (VI.2.1): unlock, and check that neither ring nor sensors fail. Done at once if it is unlocked.
    /// The id is ignored: its contacts separate while the gripper drops. While the sensors are not read the port is
    /// disabled.
    pub QC_UNLOCK: fn qc_unlock(super::Step, super::Situation) -> super::Action or () {
        Start {
            1: ring: Unread                            => Wait;
            2: connection: Tripped                     => Fail(Tripped)            -> Faulty;
            3: connection: Lost                        => Fail(Silent)             -> Faulty;
            4: connection: Stale                       => Wait;
            5: ring: Implausible                       => Fail(SensorMalfunction)  -> Faulty;
            6: ring: Unlocked                          => Report(Unlocked)         -> Watch;
            7: ring: Locked | Between, clock: Running  => Unlock;
            8: ring: Locked | Between, clock: Expired  => Fail(Stuck)              -> Stuck;
        }
        Watch | Stuck | Faulty {
            9: otherwise                               => consult;
        }
    }
}
