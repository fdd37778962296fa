use rcs_core::decision_table;

decision_table! {
    /// RELEASE-TOOL (V.4.1): release a tool in the transfer location, then go to the end-at location. The command
    /// finishes at once if the tool gripper is free and there. Repeated after an interruption, it continues: open
    /// fingers move out of the drum, and a robot with a free gripper before the drum only leaves. Without an end-at
    /// location the robot stays at the drum; if it has been moved away since, the command cannot finish. An update is
    /// sent for a tool that the database has as held by the robot (an extension: SPECNOTES.md).
    pub RELEASE_TOOL: fn release_tool(enum ReleaseToolStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                                                     => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  tool: None                                                     => Fail(NotPrepared);
            3:  drum: Inside                                                   => ReleaseTool  -> Releasing;
            4:  tool: Held, station: Transfer | Unplaced                       => ReleaseTool  -> Releasing;
            5:  tool: Held, station: Safe | Elsewhere                          => Fail(NotPrepared);
            6:  tool: Unsure                                                   => Fail(UnknownHeld);
            7:  tool: Free, station: Unplaced, resumed: AtTool                 => ReleaseTool  -> Releasing;
            8:  tool: Free, ends: There                                        => Wait         -> Leaving;
            9:  tool: Free, station: Transfer, ends: Here                      => Wait         -> Leaving;
            10: tool: Free, station: Transfer, ends: Elsewhere                 => GotoEndpt    -> Leaving;
            11: tool: Free, resumed: AtTool | Leaving, ends: Elsewhere         => GotoEndpt    -> Leaving;
            12: tool: Free, resumed: AtTool | Leaving, ends: Here              => Fail(SentAway);
            13: tool: Free, resumed: Not | Begun,      ends: Here | Elsewhere  => Fail(NotPrepared);
        }
        /// The tool is being released.
        Releasing {
            14: ends: There | Elsewhere                                        => GotoEndpt    -> Leaving;
            15: ends: Here, update: None | Due                                 => Finish;
        }
        /// The robot moves to the end-at location, or stays.
        Leaving {
            16: update: None | Due                                             => Finish;
        }
        Releasing | Leaving {
            17: update: Pending                                                => SendPending  -> Updating;
        }
        /// The update with the place of the tool is sent.
        Updating {
            18: update: Pending                                                => SendPending;
            19: update: None | Due                                             => Finish;
        }
    }
}
