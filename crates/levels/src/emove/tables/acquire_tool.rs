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
            2: held: Other                          => Fail(AlreadyHolding);
            3: held: Right, at: InDrum              => Finish;
            4: held: Right, at: Elsewhere | There   => Fail(NotPrepared);
            5: held: Nothing, at: InDrum            => Fail(NotPrepared);
            6: held: Nothing, at: Elsewhere | There => OpenToApproach     -> Opening;
        }
        /// The gripper is opening.
        Opening {
            7: work: Over                           => DeltaMove(AcqNear) -> Approaching;
        }
        /// The robot is moving towards the machine tool.
        Approaching {
            8: work: Over                           => CalSensor          -> Calibrating;
        }
        /// The force sensor is being calibrated for the contact.
        Calibrating {
            9: work: Over                           => GoUntil(AcqStrike) -> Striking;
        }
        /// The robot is moving into contact with the strike plate.
        Striking {
            10: work: Over                          => CalSensor          -> Recalibrating;
        }
        /// The force sensor is being calibrated for the slide.
        Recalibrating {
            11: work: Over                          => GoUntil(AcqSlide)  -> Sliding;
        }
        /// The gripper is sliding to the left.
        Sliding {
            12: work: Over                          => Close              -> Grasping;
        }
        /// The gripper is closing.
        Grasping {
            13: fingers: Gripping                   => Acquired;
            14: fingers: Empty                      => Fail(GraspMissed);
        }
    }
}
