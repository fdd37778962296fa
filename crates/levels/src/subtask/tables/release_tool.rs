use rcs_core::decision_table;

decision_table! {
    /// RELEASE-TOOL (V.3.1): release a tool in the tool drum. Open fingers that are still around the tool, or moving
    /// out, leave the drum: E-move has their place.
    pub RELEASE_TOOL: fn release_tool(enum ReleaseToolStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                                 => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  held: Right                                => ReleaseTool  -> Releasing;
            3:  drum: Inside,   held: Nothing | Something  => ReleaseTool  -> Releasing;
            4:  drum: Inside,   held: NotKnown             => ReleaseTool  -> Releasing;
            5:  drum: Unplaced, held: Nothing              => ReleaseTool  -> Releasing;
            6:  drum: Outside,  held: Nothing              => Fail(NothingHeld);
            7:  held: Other                                => Fail(NothingHeld);
            8:  held: Something                            => Fail(UnknownHeld);
            9:  held: NotKnown                             => Fail(HeldNotKnown);
        }
        /// E-move releases the tool and leaves the drum.
        Releasing {
            10: otherwise                                  => Finish;
        }
    }
}
