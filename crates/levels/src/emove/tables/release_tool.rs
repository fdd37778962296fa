//! RELEASE-TOOL (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// RELEASE-TOOL (V.2.1): open the tool gripper, calibrate, slide to the right until the strike plate
    /// gives a moment, pull back. Done at once if the robot is before the drum with open fingers and nothing
    /// in them.
    pub RELEASE_TOOL: fn release_tool(enum ReleaseToolStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                             => Wait;
        }
        /// Nothing done yet.
        Start {
            2: at: InDrum                             => OpenToDepart       -> Opening;
            3: at: There, held: Nothing, spread: Open => Finish;
            4: at: There | Before | Elsewhere         => Fail(NotPrepared);
        }
        /// The gripper is opening.
        Opening {
            5: work: Over                             => CalSensor          -> Calibrating;
        }
        /// The force sensor is being calibrated.
        Calibrating {
            6: work: Over                             => GoUntil(RelSlide)  -> Sliding;
        }
        /// The gripper is sliding to the right.
        Sliding {
            7: work: Over                             => DeltaMove(RelBack) -> Withdrawing;
        }
        /// The robot is pulling back.
        Withdrawing {
            8: work: Over                             => Stand;
        }
    }
}
