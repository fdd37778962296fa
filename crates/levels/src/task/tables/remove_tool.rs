//! REMOVE-TOOL (V.4.1).

use rcs_core::decision_table;

decision_table! {
    /// REMOVE-TOOL (V.4.1): pull a tool that has been acquired out of the tool drum, then go to the end-at
    /// location; done at once if the tool is there.
    pub REMOVE_TOOL: fn remove_tool(enum RemoveToolStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                                                     => Wait;
        }
        /// Nothing done yet.
        Start {
            2: tool: Held, station: Transfer                                  => RemoveTool  -> Removing;
            3: tool: Held, station: Safe | Elsewhere, ends: There             => Finish;
            4: tool: Held, station: Safe | Elsewhere, ends: Here | Elsewhere  => Fail(NotPrepared);
            5: tool: Free | None                                              => Fail(NotPrepared);
        }
        /// The tool is being pulled out.
        Removing {
            6: ends: There | Elsewhere                                        => GotoEndpt   -> Leaving;
            7: ends: Here                                                     => Finish;
        }
        /// The robot is on its way to the end-at location.
        Leaving {
            8: work: Over                                                     => Finish;
        }
    }
}
