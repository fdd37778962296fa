//! UP-INIT (VI.3.1).

use rcs_core::decision_table;

decision_table! {
    /// UP-INIT (VI.3.1): close and open the gripper and read the sensors at both ends of travel and without
    /// force. Runs by itself if the gripper is there when the system is booted, and commands wait for it.
    /// Later it runs by command alone, since a part may be held: commands that need the calibration are
    /// refused. OPEN-GRIP to the open end does not need it: what is held without a calibration can be let go.
    pub UP_INIT: fn up_init(super::Phase, super::Situation) -> super::Action or super::Duty {
        Missing {
            1:  command: Nothing, gripper: Attached             => Begin                    -> Closing;
        }
        Missing | Deferred | Failed {
            2:  command: Motion, gripper: Attached              => Fail(GripNotCalibrated);
            3:  command: OpenWide, gripper: Attached            => Widen                    -> Widening;
        }
        Adopting {
            4:  gripper: Attached, sensors: Plausible           => Adopt                    -> Valid;
            5:  gripper: Attached, sensors: Implausible         => Forget                   -> Deferred;
        }
        Missing | Deferred | Failed | Valid {
            6:  command: UpInit, gripper: Attached              => Begin                    -> Closing;
        }
        Missing | Deferred | Adopting | Failed | Valid {
            7:  command: Pause | UpInit | Motion | OpenWide     => consult(Command);
            8:  command: Refused                                => consult(Refused);
            9:  command: Nothing                                => consult(Nothing);
        }
        Closing | Opening | Venting | Widening {
            10: gripper: Detached, command: UpInit | Motion | OpenWide => Fail(WrongGripper) -> Deferred;
            11: gripper: Detached                               => GiveUp                   -> Deferred;
            12: readings: Late | Implausible, command: Nothing | Refused => GiveUp          -> Failed;
            13: readings: Late | Implausible                    => Fail(GripNotCalibrated)  -> Failed;
        }
        Closing {
            14: readings: Unsteady                              => CloseFully;
            15: readings: Steady                                => NoteClosed               -> Opening;
        }
        Opening {
            16: readings: Unsteady                              => OpenFully;
            17: readings: Steady                                => NoteOpen                 -> Venting;
        }
        Venting {
            18: readings: Unsteady                              => Vent;
            19: readings: Steady, command: UpInit               => CalibrateAndFinish       -> Valid;
            20: readings: Steady                                => Calibrate                -> Valid;
        }
        Widening {
            21: readings: Unsteady                              => OpenFully;
            22: readings: Steady, command: OpenWide             => Finish                   -> Deferred;
            23: readings: Steady                                => GiveUp                   -> Deferred;
        }
    }
}
