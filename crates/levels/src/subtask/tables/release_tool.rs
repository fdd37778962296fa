//! RELEASE-TOOL (V.3.1).

use rcs_core::decision_table;

decision_table! {
    /// RELEASE-TOOL (V.3.1): let go of a tool that is in the tool drum.
    pub RELEASE_TOOL: fn release_tool(enum ReleaseToolStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                               => Wait;
        }
        /// Nothing done yet.
        Start {
            2: held: Right                                 => ReleaseTool      -> Releasing;
            3: held: Nothing | Other                       => Fail(NothingHeld);
        }
        /// E-move is letting go and leaving the drum.
        Releasing {
            4: work: Over                                  => Finish;
        }
    }
}
