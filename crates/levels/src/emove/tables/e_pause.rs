//! E-PAUSE (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// E-PAUSE (V.2.1): do nothing. The first one after the start initializes the link (IV.3.3 step 2), waits
    /// for the calibration of the parts gripper (VI.3.1 UP-INIT), and finds out where the robot is. While it
    /// stands, the joystick box has robot and gripper.
    pub E_PAUSE: fn e_pause(enum EPauseStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                                              => Wait;
        }
        /// Nothing done yet.
        Start {
            2: link: Down                                              => RobotInit -> Initializing;
            3: link: Up                                                => Pause     -> Pausing;
        }
        /// Prim is initializing the link.
        Initializing {
            4: work: Over                                              => Pause     -> Pausing;
        }
        /// The processes below are pausing.
        Pausing {
            5:  prim: Pending | Executing                              => Wait;
            6:  prim: Error | Lost                                     => PassUp;
            7:  prim: Joystick                                         => Manual    -> Standing;
            8:  prim: Done, tooling: Busy                              => Wait;
            9:  prim: Done, tooling: RingFaulty                        => FailRing;
            10: prim: Done, tooling: GripFaulty                        => FailGrip;
            11: prim: Done, tooling: Ready, place: Searching           => Wait;
            12: prim: Done, tooling: Ready, place: Known | Unknown     => Finish    -> Standing;
        }
        /// They pause. The operator may take the robot and give it back as long as the command stands.
        Standing {
            13: button: Open                                           => OpenByHand;
            14: button: Close                                          => CloseByHand;
            15: button: None, prim: Joystick                           => Manual;
            16: button: None, prim: Done                               => Finish;
            17: button: None, prim: Pending | Executing | Error | Lost => Wait;
        }
    }
}
