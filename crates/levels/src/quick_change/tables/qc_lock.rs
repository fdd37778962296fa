use rcs_core::decision_table;

decision_table! {
    /// QC-LOCK (VI.2.1): lock, check that the ring did not get stuck, disable the control port. Done at once if it
    /// is locked. While the sensors are not read the port is disabled.
    pub QC_LOCK: fn qc_lock(super::Step, super::Situation) -> super::Action or () {
        Start {
            1:  ring: Unread                              => Wait;
            2:  connection: Tripped                       => Fail(Tripped)            -> Faulty;
            3:  connection: Lost                          => Fail(Silent)             -> Faulty;
            4:  connection: Stale                         => Wait;
            5:  ring: Implausible                         => Fail(SensorMalfunction)  -> Faulty;
            6:  ring: Locked,             id: Illegal     => Fail(SensorMalfunction)  -> Faulty;
            7:  ring: Locked,             id: Legal       => Report(Locked)           -> Watch;
            8:  ring: Unlocked | Between, clock: Running  => Lock;
            9:  ring: Unlocked | Between, clock: Expired  => Fail(Stuck)              -> Stuck;
        }
        Watch | Stuck | Faulty {
            10: otherwise                                 => consult;
        }
    }
}
