use rcs_core::decision_table;

decision_table! {
    /// INSERT-TOOL (V.4.1): insert a tool, which a MOVE has brought near the tool drum, into the drum. The command
    /// finishes at once if the tool is there. If the robot is at no known place, E-move determines whether it is on
    /// the way into the drum.
    pub INSERT_TOOL: fn insert_tool(enum InsertToolStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                                       => Wait;
        }
        /// Nothing done yet.
        Start {
            2: tool: Held, drum: Inside                         => Finish;
            3: tool: Held, station: Safe | Transfer | Unplaced  => InsertTool  -> Inserting;
            4: tool: Held, station: Elsewhere                   => Fail(NotPrepared);
            5: tool: Free | None                                => Fail(NotPrepared);
            6: tool: Unsure                                     => Fail(UnknownHeld);
        }
        /// The tool is being inserted.
        Inserting {
            7: otherwise                                        => Finish;
        }
    }
}
