use rcs_core::decision_table;

decision_table! {
    /// REMOVE-TOOL (V.4.1): pull an acquired tool out of the tool drum, then go to the end-at location. The command
    /// finishes at once if the tool is there. Repeated after an interruption, it continues. Without an end-at
    /// location the robot stays at the drum; if it has been moved away since, the command cannot finish.
    pub REMOVE_TOOL: fn remove_tool(enum RemoveToolStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                                                        => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  tool: Free | None                                                 => Fail(NotPrepared);
            3:  tool: Unsure                                                      => Fail(UnknownHeld);
            4:  station: Unplaced, resumed: Leaving                               => GotoEndpt   -> Leaving;
            5:  station: Transfer | Unplaced                                      => RemoveTool  -> Removing;
            6:  ends: There                                                       => Finish;
            7:  station: Safe | Elsewhere, resumed: AtTool | Leaving, ends: Here  => Fail(SentAway);
            8:  resumed: AtTool | Leaving, ends: Elsewhere                        => GotoEndpt   -> Leaving;
            9:  resumed: Not | Begun,      ends: Here | Elsewhere                 => Fail(NotPrepared);
        }
        /// The tool is being pulled out.
        Removing {
            10: ends: There | Elsewhere                                           => GotoEndpt   -> Leaving;
            11: ends: Here                                                        => Finish;
        }
        /// The robot moves to the end-at location.
        Leaving {
            12: otherwise                                                         => Finish;
        }
    }
}
