//! UP-INIT (VI.3.1).

use rcs_core::decision_table;

decision_table! {
    /// UP-INIT (VI.3.1): close and open the gripper and read the sensors at both ends of travel and without
    /// force. Runs by itself if the gripper is there when the system is booted, and commands wait for it. Later
    /// it runs by command alone, since a part may be held: commands that need the calibration are refused.
    pub UP_INIT: fn up_init(super::Phase, super::Situation) -> super::Action or super::Duty {
        Missing {
            1:  command: Nothing, gripper: Attached             => Begin                    -> Closing;
        }
        Missing | Deferred | Failed {
            2:  command: Motion, gripper: Attached              => Fail(GripNotCalibrated);
        }
        Adopting {
            3:  gripper: Attached, sensors: Plausible           => Adopt                    -> Valid;
            4:  gripper: Attached, sensors: Implausible         => Forget                   -> Deferred;
        }
        Missing | Deferred | Failed | Valid {
            5:  command: UpInit, gripper: Attached              => Begin                    -> Closing;
        }
        Missing | Deferred | Adopting | Failed | Valid {
            6:  command: Pause | UpInit | Motion                => consult(Command);
            7:  command: Refused                                => consult(Refused);
            8:  command: Nothing                                => consult(Nothing);
        }
        Closing | Opening | Venting {
            9:  gripper: Detached, command: UpInit | Motion     => Fail(WrongGripper)       -> Deferred;
            10: gripper: Detached                               => GiveUp                   -> Deferred;
            11: readings: Late | Implausible, command: Nothing | Refused => GiveUp          -> Failed;
            12: readings: Late | Implausible                    => Fail(GripNotCalibrated)  -> Failed;
        }
        Closing {
            13: readings: Unsteady                              => CloseFully;
            14: readings: Steady                                => NoteClosed               -> Opening;
        }
        Opening {
            15: readings: Unsteady                              => OpenFully;
            16: readings: Steady                                => NoteOpen                 -> Venting;
        }
        Venting {
            17: readings: Unsteady                              => Vent;
            18: readings: Steady, command: UpInit               => CalibrateAndFinish       -> Valid;
            19: readings: Steady                                => Calibrate                -> Valid;
        }
    }
}
