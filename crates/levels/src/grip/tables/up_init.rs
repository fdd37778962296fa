//! UP-INIT (VI.3.1), and the effects of a missing calibration.

use rcs_core::decision_table;

decision_table! {
    /// UP-INIT (VI.3.1): close and open the gripper and read the sensors at both ends of travel and without force.
    /// OPEN-GRIP without a calibration opens it to the end of travel. CALIBRATION, which is consulted after it,
    /// starts both.
    pub UP_INIT: fn up_init(super::GripPhase, super::Situation) -> super::Action or () {
        Missing | Deferred | Adopting | Valid | Failed {
            1:  otherwise                            => consult;
        }
        any {
            2:  gripper: Detached, command: UpInit | Motion | OpenWide => Fail(WrongGripper) -> Deferred;
            3:  gripper: Detached                    => GiveUp                   -> Deferred;
            4:  readings: Late | Implausible, command: Nothing | Refused => GiveUp -> Failed;
            5:  readings: Late | Implausible         => Fail(GripNotCalibrated)  -> Failed;
        }
        Closing {
            6:  readings: Unsteady                   => CloseFully;
            7:  readings: Steady                     => NoteClosed               -> Opening;
        }
        Opening | Widening {
            8:  readings: Unsteady                   => OpenFully;
        }
        Opening {
            9:  readings: Steady                     => NoteOpen                 -> Venting;
        }
        Venting {
            10: readings: Unsteady                   => Vent;
            11: readings: Steady, command: UpInit    => CalibrateAndFinish       -> Valid;
            12: readings: Steady                     => Calibrate                -> Valid;
        }
        Widening {
            13: readings: Steady, command: OpenWide  => Finish                   -> Deferred;
            14: readings: Steady                     => GiveUp                   -> Deferred;
        }
    }
}

decision_table! {
    /// CALIBRATION: UP-INIT starts by itself if the gripper is attached when the system starts (VI.3.1), and
    /// commands wait for it. Later it starts only by command, since a part may be held: commands that need the
    /// calibration are refused. OPEN-GRIP to the open end does not need it, so that a part can be released without
    /// a calibration.
    pub CALIBRATION: fn calibration(super::GripPhase, super::Situation) -> super::Action or super::GripDuty {
        Missing {
            1: gripper: Attached, command: Nothing          => Begin   -> Closing;
        }
        Missing | Deferred | Failed {
            2: gripper: Attached, command: Motion           => Fail(GripNotCalibrated);
            3: gripper: Attached, command: OpenWide         => Widen   -> Widening;
        }
        Adopting {
            4: gripper: Attached, sensors: Plausible        => Adopt   -> Valid;
            5: gripper: Attached, sensors: Implausible      => Forget  -> Deferred;
        }
        any {
            6: gripper: Attached, command: UpInit           => Begin   -> Closing;
            7: command: Pause | UpInit | Motion | OpenWide  => consult(Command);
            8: command: Refused                             => consult(Refused);
            9: command: Nothing                             => consult(Nothing);
        }
    }
}
