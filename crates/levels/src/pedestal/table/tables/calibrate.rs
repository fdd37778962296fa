//! CALIBRATE (IV.1 step 3, IV.5.1 step 10).

use rcs_core::decision_table;

decision_table! {
    /// CALIBRATE (IV.1 step 3, IV.5.1 step 10): turn to the + limit, set the counter to zero, park at -20.00. It
    /// starts by itself when the system starts, and before the first command that turns the table; commands wait
    /// for it. It fails if the motor does not take its order, does not come to rest in time, or stops elsewhere. A
    /// process that is restarted in the middle of a job stops the table and adopts its last calibration, if counter
    /// and potentiometer agree.
    pub CALIBRATE: fn calibrate(super::TablePhase, super::Situation) -> super::Action or super::TableDuty {
        Missing {
            1:  command: Nothing                                     => SeekLimit         -> Seeking;
        }
        Missing | Deferred | Failed {
            2:  command: Turn                                        => SeekLimit         -> Seeking;
        }
        Missing | Deferred | Failed | Valid {
            3:  command: Calibrate                                   => SeekLimit         -> Seeking;
            4:  command: Pause | Turn                                => consult(Command);
            5:  command: Nothing | Refused                           => consult(Nothing);
        }
        Adopting {
            6:  motor: Turning,            clock: Running            => Stop;
            7:  motor: Pending | Settling, clock: Running            => Wait;
            8:  motor: Standing,           counter: Agrees           => EndWait           -> Valid;
            9:  otherwise                                            => EndWait           -> Deferred;
        }
        Seeking | Setting | Parking {
            10: motor: Pending | Turning | Settling, clock: Running  => Wait;
        }
        Seeking {
            11: motor: Standing, place: There                        => SetCounter        -> Setting;
        }
        Setting {
            12: motor: Standing, place: There                        => Park              -> Parking;
        }
        Parking {
            13: motor: Standing, place: There, command: Calibrate    => Finish            -> Valid;
            14: motor: Standing, place: There                        => EndWait           -> Valid;
        }
        Seeking | Setting | Parking {
            15: command: Calibrate | Turn                            => Lose(TableStuck)  -> Failed;
            16: command: Nothing | Refused | Pause                   => GiveUp            -> Failed;
        }
    }
}
