//! E-PAUSE (V.2.1): the stop, and the operator's commands while the robot is at rest.

use rcs_core::{Plain, decision_table};

/// Steps of E-PAUSE.
///
/// ```text
///   E-PAUSE:   Start -> (Initializing) -> (Awaiting) -> Pausing ---> done
///                                                          |          |
///              (InitializingAgain -> PausingAgain) <-------'          v
///   STANDING:                                            Led <--> Standing
///                                                          '-> Resting -> done
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EPauseStep {
    /// Nothing done yet.
    Start,
    /// The robot is pausing; the fingers still move.
    Awaiting,
    /// Prim is initializing the link.
    Initializing,
    /// The processes below are pausing.
    Pausing,
    /// The processes below pause. The operator may take the robot and give it back until the next command.
    Standing,
    /// The operator controls the robot, or has just returned the control.
    Led,
    /// The processes below pause again after the operator has given the robot back.
    Resting,
    /// Prim is initializing a link that has failed while the robot paused.
    InitializingAgain,
    /// The processes below are pausing again.
    PausingAgain,
}

decision_table! {
    /// STANDING: E-PAUSE (V.2.1) after its end. Until the next command, the joystick box controls robot and gripper.
    /// A link failure is reported with `done`, and the next motion restarts the link. When the operator
    /// returns the control, the processes below pause again, because jaws keep their air and may have begun to close.
    pub STANDING: fn standing(self::EPauseStep, struct of super::Senses) -> super::Action or () {
        any {
            1:  work: Busy                        => Wait;
        }
        Start | Awaiting | Initializing | Pausing | Resting | InitializingAgain | PausingAgain {
            2:  otherwise                         => consult;
        }
        any {
            3:  button: Open                      => OpenByHand;
            4:  button: Close                     => CloseByHand;
            5:  prim: Joystick                    => Manual  -> Led;
            6:  prim: Pending | Executing | Lost  => Wait;
        }
        Standing {
            7:  prim: Done | Error                => Finish;
        }
        Led {
            8:  prim: Error                       => Finish  -> Standing;
            9:  prim: Done, motion: Moving        => Wait;
            10: prim: Done, motion: AtRest        => Pause   -> Resting;
        }
    }
}

decision_table! {
    /// E-PAUSE (V.2.1): do nothing. The first one after the start initializes the link (IV.3.3 step 2), waits for the
    /// calibration of the parts gripper (VI.3.1 UP-INIT), and searches for the place of the robot. Moving fingers
    /// first finish their order: a valve left open would close them with the full supply pressure. A link that fails
    /// before the pause is done is initialized again, once. STANDING decides after that.
    pub E_PAUSE: fn e_pause(self::EPauseStep, struct of super::Senses) -> super::Action {
        Start {
            1:  link: Down                              => RobotInit  -> Initializing;
        }
        Start | Initializing {
            2:  motion: Moving                          => StopRobot  -> Awaiting;
        }
        Awaiting {
            3:  motion: Moving                          => Wait;
        }
        Start | Initializing | Awaiting {
            4:  motion: AtRest                          => Pause      -> Pausing;
        }
        InitializingAgain {
            5:  otherwise                               => Pause      -> PausingAgain;
        }
        any {
            6:  prim: Pending | Executing               => Wait;
            7:  prim: Joystick                          => Manual     -> Led;
        }
        Pausing {
            8:  prim: Error                             => RobotInit  -> InitializingAgain;
        }
        Resting {
            9:  prim: Error                             => Finish     -> Standing;
        }
        any {
            10: prim: Error | Lost                      => PassUp;
            11: tooling: Busy                           => Wait;
            12: tooling: RingFaulty                     => FailRing;
            13: tooling: GripFaulty                     => FailGrip;
            14: tooling: Ready, place: Searching        => Wait;
            15: tooling: Ready, place: Known | Unknown  => Finish     -> Standing;
        }
    }
}
