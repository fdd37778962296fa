//! UP-INIT (VI.3.1).

use rcs_core::decision_table;

decision_table! {
    /// UP-INIT (VI.3.1): close and open the gripper and read the sensors at both ends of travel and without
    /// force. Runs by itself if the gripper is there when the system is booted, and before the first command
    /// that moves the fingers. Commands wait for it.
    pub UP_INIT: fn up_init(super::Phase, super::Situation) -> super::Action or super::Duty {
        Missing {
            1:  command: Nothing, gripper: Attached             => Begin                    -> Closing;
        }
        Missing | Deferred | Failed {
            2:  command: Motion, gripper: Attached              => Begin                    -> Closing;
        }
        Missing | Deferred | Failed | Valid {
            3:  command: UpInit, gripper: Attached              => Begin                    -> Closing;
            4:  command: Pause | UpInit | Motion                => consult(Command);
            5:  command: Refused                                => consult(Refused);
            6:  command: Nothing                                => consult(Nothing);
        }
        Closing | Opening | Venting {
            7:  gripper: Detached, command: UpInit | Motion     => Fail(WrongGripper)       -> Deferred;
            8:  gripper: Detached                               => GiveUp                   -> Deferred;
            9:  readings: Late | Implausible, command: Nothing | Refused => GiveUp          -> Failed;
            10: readings: Late | Implausible                    => Fail(GripNotCalibrated)  -> Failed;
        }
        Closing {
            11: readings: Unsteady                              => CloseFully;
            12: readings: Steady                                => NoteClosed               -> Opening;
        }
        Opening {
            13: readings: Unsteady                              => OpenFully;
            14: readings: Steady                                => NoteOpen                 -> Venting;
        }
        Venting {
            15: readings: Unsteady                              => Vent;
            16: readings: Steady, command: UpInit               => CalibrateAndFinish       -> Valid;
            17: readings: Steady                                => Calibrate                -> Valid;
        }
    }
}
