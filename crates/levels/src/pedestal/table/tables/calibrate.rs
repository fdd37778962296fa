//! CALIBRATE (IV.1 step 3, IV.5.1 step 10).

use rcs_core::decision_table;

decision_table! {
    /// CALIBRATE (IV.1 step 3, IV.5.1 step 10): turn to the + limit and give the counter the angle of the
    /// limit. Runs by itself when the table is booted, and before the first command that turns it. Commands
    /// wait for it. A motor that does not take its order, does not come to rest in time or stands elsewhere
    /// ends it.
    pub CALIBRATE: fn calibrate(super::Phase, super::Situation) -> super::Action or super::Duty {
        Missing {
            1:  command: Nothing                                    => SeekLimit            -> Seeking;
        }
        Missing | Deferred | Failed {
            2:  command: Turn                                       => SeekLimit            -> Seeking;
        }
        Missing | Deferred | Failed | Valid {
            3:  command: Calibrate                                  => SeekLimit            -> Seeking;
            4:  command: Pause | Turn                               => consult(Command);
            5:  command: Nothing | Refused                          => consult(Nothing);
        }
        Seeking | Setting {
            6:  motor: Pending | Turning, clock: Running            => Wait;
        }
        Seeking {
            7:  motor: Standing, place: There                       => SetCounter           -> Setting;
        }
        Setting {
            8:  motor: Standing, place: There, command: Calibrate   => Finish               -> Valid;
            9:  motor: Standing, place: There                       => EndCalibration       -> Valid;
        }
        Seeking | Setting {
            10: command: Calibrate | Turn                           => Lose(TableStuck)     -> Failed;
            11: command: Nothing | Refused | Pause                  => GiveUp               -> Failed;
        }
    }
}
