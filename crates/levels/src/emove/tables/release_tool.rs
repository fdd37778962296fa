//! RELEASE-TOOL (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// RELEASE-TOOL (V.2.1): open the tool gripper, calibrate, slide to the right until the strike plate exerts a
    /// moment, pull back. Done at once if the robot is before the drum with open, empty fingers. After an
    /// interruption the command continues from the robot's position at the drum (docs/design/recovery.md "Drum").
    pub RELEASE_TOOL: fn release_tool(enum ReleaseToolStep, struct of super::Senses) -> super::Action {
        any {
            1:  work: Busy                                  => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  at: InDrum                                  => OpenToDepart          -> Opening;
            3:  at: There, held: Nothing, spread: Open      => Finish;
            4:  at: There | Before                          => Fail(NotPrepared);
            5:  drum: Inside                                => OpenToDepart          -> Opening;
            6:  drum: Off | Entering                        => Fail(NotPrepared);
            7:  held: Right | Other | Something | NotKnown  => Fail(NotPrepared);
            8:  spread: Narrow | Unknown                    => Fail(NotPrepared);
            9:  drum: Sliding                               => GoUntil(RelSlideOn)   -> Sliding;
            10: drum: Clear | Before                        => DeltaMove(RelBackOn)  -> Withdrawing;
        }
        /// The gripper is opening.
        Opening {
            11: otherwise                                   => CalSensor(Drum)       -> Calibrating;
        }
        /// The force sensor is being calibrated.
        Calibrating {
            12: otherwise                                   => GoUntil(RelSlide)     -> Sliding;
        }
        /// The gripper is sliding to the right.
        Sliding {
            13: otherwise                                   => DeltaMove(RelBack)    -> Withdrawing;
        }
        /// The robot is pulling back.
        Withdrawing {
            14: otherwise                                   => Stand;
        }
    }
}
