//! ACQUIRE-TOOL (V.3.1).

use rcs_core::decision_table;

decision_table! {
    /// ACQUIRE-TOOL (V.3.1): move to a tool in the tool drum and grasp it. Of one that is held E-move says
    /// whether it is held in the drum. Something unknown that is held in the drum is what an interrupted
    /// grasp has closed on: the grasp is made again.
    pub ACQUIRE_TOOL: fn acquire_tool(enum AcquireToolStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                     => Wait;
        }
        /// Nothing done yet.
        Start {
            2: held: Other                    => Fail(AlreadyHolding);
            3: held: Nothing | Right          => AcquireTool  -> Acquiring;
            4: held: Something, drum: Inside  => AcquireTool  -> Acquiring;
        }
        /// E-move is going to the tool and grasping it.
        Acquiring {
            5: held: Right                    => Finish;
            6: held: Nothing | Other          => Fail(GraspMissed);
        }
        any {
            7: held: Something                => Fail(UnknownHeld);
            8: held: NotKnown                 => Fail(HeldNotKnown);
        }
    }
}
