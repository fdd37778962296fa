//! ACQUIRE-TOOL (V.3.1).

use rcs_core::decision_table;

decision_table! {
    /// ACQUIRE-TOOL (V.3.1): move to a tool in the tool drum and grasp it; done at once if it is held.
    /// Something unknown that is held in the drum is what an interrupted grasp has closed on: the grasp is
    /// made again.
    pub ACQUIRE_TOOL: fn acquire_tool(enum AcquireToolStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                               => Wait;
        }
        /// Nothing done yet.
        Start {
            2: held: Right                                 => Finish;
            3: held: Other                                 => Fail(AlreadyHolding);
            4: held: Nothing                               => AcquireTool      -> Acquiring;
            5: held: Something, drum: Inside               => AcquireTool      -> Acquiring;
        }
        /// E-move is going to the tool and grasping it.
        Acquiring {
            6: held: Right                                 => Finish;
            7: held: Nothing | Other                       => Fail(GraspMissed);
        }
        any {
            8: held: Something                             => Fail(UnknownHeld);
            9: held: NotKnown                              => Fail(HeldNotKnown);
        }
    }
}
