use rcs_core::decision_table;

decision_table! {
    /// ACQUIRE-TOOL (V.3.1): move to a tool in the tool drum and grasp it. For a held tool, E-move determines whether
    /// it is in the drum. Something unknown that is held in the drum is the result of an interrupted grasp, which is
    /// repeated.
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
        /// E-move moves to the tool and grasps it.
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
