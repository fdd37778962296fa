//! RELEASE-TOOL (V.4.1).

use rcs_core::decision_table;

decision_table! {
    /// RELEASE-TOOL (V.4.1): let go of a tool in the transfer location, then go to the end-at location; done
    /// at once if the tool gripper is free and there.
    pub RELEASE_TOOL: fn release_tool(enum ReleaseToolStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                             => Wait;
        }
        /// Nothing done yet.
        Start {
            2: tool: Held, station: Transfer          => ReleaseTool  -> Releasing;
            3: tool: Held, station: Safe | Elsewhere  => Fail(NotPrepared);
            4: tool: Free, ends: There                => Finish;
            5: tool: Free, ends: Here | Elsewhere     => Fail(NotPrepared);
            6: tool: None                             => Fail(NotPrepared);
        }
        /// The tool is being let go.
        Releasing {
            7: ends: There | Elsewhere                => GotoEndpt    -> Leaving;
            8: ends: Here                             => Finish;
        }
        /// The robot is on its way to the end-at location.
        Leaving {
            9: work: Over                             => Finish;
        }
    }
}
