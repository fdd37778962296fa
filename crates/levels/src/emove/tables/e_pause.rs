//! E-PAUSE (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// E-PAUSE (V.2.1): do nothing. The first one after the start initializes the link (IV.3.3 step 2), waits
    /// for the calibration of the parts gripper (VI.3.1 UP-INIT), and finds out where the robot is. Fingers
    /// that move do first what they were told: a valve that is left open would close them with the whole
    /// supply pressure. While it stands, the joystick box has robot and gripper. A link that fails before it
    /// is done is initialized again, once; one that fails afterwards is reported beside `done`, and the next
    /// motion restarts it. When the operator gives the robot back, the processes below pause again: jaws keep their
    /// air, and may have begun to close.
    pub E_PAUSE: fn e_pause(enum EPauseStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                                              => Wait;
        }
        /// Nothing done yet.
        Start {
            2: link: Down                                              => RobotInit -> Initializing;
        }
        /// The robot is pausing; the fingers still move.
        Awaiting {
            3: motion: Moving                                          => Wait;
        }
        Start | Initializing {
            4: motion: Moving                                          => StopRobot -> Awaiting;
        }
        /// Prim is initializing the link.
        Initializing {
            5: motion: AtRest                                          => Pause     -> Pausing;
        }
        Start | Awaiting {
            6: motion: AtRest                                          => Pause     -> Pausing;
        }
        Pausing | PausingAgain | Resting {
            7:  prim: Pending | Executing                              => Wait;
        }
        /// The processes below are pausing.
        Pausing {
            8:  prim: Error                                            => RobotInit -> InitializingAgain;
        }
        Pausing | PausingAgain | Resting {
            9:  prim: Lost                                             => PassUp;
            10: prim: Joystick                                         => Manual    -> Led;
            11: prim: Done, tooling: Busy                              => Wait;
            12: prim: Done, tooling: RingFaulty                        => FailRing;
            13: prim: Done, tooling: GripFaulty                        => FailGrip;
            14: prim: Done, tooling: Ready, place: Searching           => Wait;
            15: prim: Done, tooling: Ready, place: Known | Unknown     => Finish    -> Standing;
        }
        /// They pause. The operator may take the robot and give it back as long as the command stands.
        Standing {
            16: button: None, prim: Done | Error                       => Finish;
        }
        /// The operator has the robot, or has just given it back.
        Led {
            17: button: None, prim: Error                              => Finish    -> Standing;
            18: button: None, prim: Done, motion: Moving               => Wait;
            19: button: None, prim: Done, motion: AtRest               => Pause     -> Resting;
        }
        Standing | Led {
            20: button: None, prim: Joystick                           => Manual    -> Led;
            21: button: None, prim: Pending | Executing | Lost         => Wait;
            22: button: Open                                           => OpenByHand;
            23: button: Close                                          => CloseByHand;
        }
        /// The processes below pause again after the operator has given the robot back.
        Resting {
            24: prim: Error                                            => Finish    -> Standing;
        }
        /// Prim is initializing a link that has failed while the robot paused.
        InitializingAgain {
            25: work: Over                                             => Pause     -> PausingAgain;
        }
        /// The processes below are pausing once more.
        PausingAgain {
            26: prim: Error                                            => PassUp;
        }
    }
}
