//! E-PAUSE (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// E-PAUSE (V.2.1): do nothing. The first one after the start initializes the link (IV.3.3 step 2), waits
    /// for the calibration of the parts gripper (VI.3.1 UP-INIT), and finds out where the robot is. While it
    /// stands, the joystick box has robot and gripper. A link that fails before it is done is initialized
    /// again; one that fails afterwards is reported.
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
            6:  prim: Error                                            => RobotInit -> Initializing;
            7:  prim: Lost                                             => PassUp;
            8:  prim: Joystick                                         => Manual    -> Standing;
            9:  prim: Done, tooling: Busy                              => Wait;
            10: prim: Done, tooling: RingFaulty                        => FailRing;
            11: prim: Done, tooling: GripFaulty                        => FailGrip;
            12: prim: Done, tooling: Ready, place: Searching           => Wait;
            13: prim: Done, tooling: Ready, place: Known | Unknown     => Finish    -> Standing;
        }
        /// They pause. The operator may take the robot and give it back as long as the command stands.
        Standing {
            14: button: Open                                           => OpenByHand;
            15: button: Close                                          => CloseByHand;
            16: button: None, prim: Joystick                           => Manual;
            17: button: None, prim: Done                               => Finish;
            18: button: None, prim: Pending | Executing | Lost         => Wait;
            19: button: None, prim: Error                              => PassUp;
        }
    }
}
