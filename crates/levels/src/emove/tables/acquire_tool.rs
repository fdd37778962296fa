//! ACQUIRE-TOOL (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// ACQUIRE-TOOL (V.2.1): open the tool gripper, move towards the machine tool, calibrate, touch the
    /// strike plate, calibrate, slide to the left around the tool, grasp it. Done at once if it is held in
    /// the drum.
    pub ACQUIRE_TOOL: fn acquire_tool(enum AcquireToolStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                           => Wait;
        }
        /// Nothing done yet.
        Start {
            2: held: Other | Something              => Fail(AlreadyHolding);
            3: held: NotKnown                       => Fail(HeldNotKnown);
            4: held: Right, at: InDrum              => Finish;
            5: held: Right, at: Elsewhere | Before | There   => Fail(NotPrepared);
            6: held: Nothing, at: InDrum | Elsewhere => Fail(NotPrepared);
            7: held: Nothing, at: Before | There    => OpenToApproach     -> Opening;
        }
        /// The gripper is opening.
        Opening {
            8: work: Over                           => DeltaMove(AcqNear) -> Approaching;
        }
        /// The robot is moving towards the machine tool.
        Approaching {
            9: work: Over                           => CalSensor          -> Calibrating;
        }
        /// The force sensor is being calibrated for the contact.
        Calibrating {
            10: work: Over                           => GoUntil(AcqStrike) -> Striking;
        }
        /// The robot is moving into contact with the strike plate.
        Striking {
            11: work: Over                          => CalSensor          -> Recalibrating;
        }
        /// The force sensor is being calibrated for the slide.
        Recalibrating {
            12: work: Over                          => GoUntil(AcqSlide)  -> Sliding;
        }
        /// The gripper is sliding to the left.
        Sliding {
            13: work: Over                          => Close              -> Grasping;
        }
        /// The gripper is closing.
        Grasping {
            14: fingers: Gripping                   => Acquired;
            15: fingers: Empty                      => Fail(GraspMissed);
        }
    }
}
