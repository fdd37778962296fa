use rcs_core::decision_table;

decision_table! {
    /// INSERT-TOOL (V.3.1): insert a tool into the tool drum. The gripper holds it until RELEASE-TOOL.
    pub INSERT_TOOL: fn insert_tool(enum InsertToolStep, super::Situation) -> super::Action {
        any {
            1: work: Busy             => Wait;
        }
        /// Nothing done yet.
        Start {
            2: held: Right            => InsertTool  -> Inserting;
            3: held: Nothing | Other  => Fail(NothingHeld);
        }
        /// E-move is inserting the tool.
        Inserting {
            4: held: Right            => Finish;
            5: held: Nothing | Other  => Fail(ObjectLost);
        }
        any {
            6: held: Something        => Fail(UnknownHeld);
            7: held: NotKnown         => Fail(HeldNotKnown);
        }
    }
}
