//! ACQUIRE-TOOL (V.3.1).

use rcs_core::decision_table;

decision_table! {
    /// ACQUIRE-TOOL (V.3.1): move to a tool in the tool drum and grasp it; done at once if it is held.
    pub ACQUIRE_TOOL: fn acquire_tool(enum AcquireToolStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                               => Wait;
        }
        /// Nothing done yet.
        Start {
            2: held: Right                                 => Finish;
            3: held: Other                                 => Fail(AlreadyHolding);
            4: held: Nothing                               => AcquireTool      -> Acquiring;
        }
        /// E-move is going to the tool and grasping it.
        Acquiring {
            5: held: Right                                 => Finish;
            6: held: Nothing | Other                       => Fail(GraspMissed);
        }
    }
}
