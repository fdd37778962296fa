//! ACQUIRE-TOOL (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// ACQUIRE-TOOL (V.2.1): open the tool gripper, move towards the machine tool, calibrate, touch the strike plate,
    /// calibrate, slide to the left around the tool, grasp it. Done at once if the tool is in the drum and held
    /// between the fingers. After an interruption the command continues from the robot's position at the drum
    /// (docs/design/recovery.md "Drum"): fingers around the tool close, others slide on, or touch the strike plate
    /// again.
    pub ACQUIRE_TOOL: fn acquire_tool(enum AcquireToolStep, struct of super::Senses) -> super::Action {
        any {
            1:  work: Busy                                   => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  held: Other                                  => Fail(AlreadyHolding);
            3:  held: NotKnown                               => Fail(HeldNotKnown);
            4:  held: Right, fingers: Gripping, at: InDrum   => Finish;
            5:  held: Right, at: Elsewhere | Before | There  => Fail(NotPrepared);
            6:  at: InDrum                                   => Close                -> Grasping;
            7:  at: Elsewhere, drum: Inside                  => Close                -> Grasping;
            8:  held: Something                              => Fail(AlreadyHolding);
            9:  at: Before | There                           => OpenToApproach       -> Opening;
            10: drum: Before | Clear                         => OpenToApproach       -> Opening;
            11: drum: Sliding, spread: Open                  => GoUntil(AcqSlideOn)  -> Sliding;
            12: drum: Off | Entering | Sliding               => Fail(NotPrepared);
        }
        /// The gripper is opening.
        Opening {
            13: otherwise                                    => DeltaMove(AcqNear)   -> Approaching;
        }
        /// The robot is moving towards the machine tool.
        Approaching {
            14: otherwise                                    => CalSensor(Drum)      -> Calibrating;
        }
        /// The force sensor is being calibrated for the contact.
        Calibrating {
            15: otherwise                                    => GoUntil(AcqStrike)   -> Striking;
        }
        /// The robot is moving into contact with the strike plate.
        Striking {
            16: otherwise                                    => CalSensor(Drum)      -> Recalibrating;
        }
        /// The force sensor is being calibrated for the slide.
        Recalibrating {
            17: otherwise                                    => GoUntil(AcqSlide)    -> Sliding;
        }
        /// The gripper is sliding to the left.
        Sliding {
            18: otherwise                                    => Close                -> Grasping;
        }
        /// The gripper is closing.
        Grasping {
            19: fingers: Gripping                            => Acquired;
            20: fingers: Empty                               => Fail(NoToolInDrum);
        }
    }
}
