use rcs_core::decision_table;

decision_table! {
    /// REMOVE-TOOL (V.3.1): pull an acquired tool out of the tool drum.
    pub REMOVE_TOOL: fn remove_tool(enum RemoveToolStep, super::Situation) -> super::Action {
        any {
            1: work: Busy             => Wait;
        }
        /// Nothing done yet.
        Start {
            2: held: Right            => RemoveTool  -> Removing;
            3: held: Nothing | Other  => Fail(NothingHeld);
        }
        /// E-move pulls the tool out.
        Removing {
            4: held: Right            => Finish;
            5: held: Nothing | Other  => Fail(ObjectLost);
        }
        any {
            6: held: Something        => Fail(UnknownHeld);
            7: held: NotKnown         => Fail(HeldNotKnown);
        }
    }
}
