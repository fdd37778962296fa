use rcs_core::decision_table;

decision_table! {
    /// QC-PAUSE (VI.2.1): do nothing; the sensors are checked for the status. Also consulted without a command and
    /// after the end of other commands, whose failure is reported until the next command.
    pub QC_PAUSE: fn qc_pause(super::Step, super::Situation) -> super::Action {
        Stuck {
            1: otherwise          => Report(Stuck);
        }
        Faulty {
            2: otherwise          => Report(SensorMalfunction);
        }
        Start | Watch {
            3: ring: Unread       => Wait;
            4: ring: Implausible  => Report(SensorMalfunction);
            5: id: Illegal        => Report(SensorMalfunction);
            6: ring: Locked       => Report(Locked);
            7: ring: Unlocked     => Report(Unlocked);
            8: ring: Between      => Report(Stuck);
        }
    }
}
