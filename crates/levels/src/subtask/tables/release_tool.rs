//! RELEASE-TOOL (V.3.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, interface::Reason, table::Decision};

use super::{Action, Choice, Held, Situation};

coded_enum! {
    /// Reference action of RELEASE-TOOL.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// E-move is letting go and leaving the drum.
        Releasing = "releasing",
    }
}

decision_table! {
    /// RELEASE-TOOL (V.3.1): let go of a tool that is in the tool drum.
    pub RELEASE_TOOL: fn release_tool(step: Step, held: Held, emove: Lower) -> (Action, Step) {
        //    step        held              E-move                     action                     next
        1: ( Start     , Right           , _                       ) => ReleaseTool               , Releasing ;
        2: ( Start     , Nothing | Other , _                       ) => Fail(Reason::NothingHeld) , Start     ;
        3: ( Releasing , _               , Pending | Executing     ) => Wait                      , Releasing ;
        4: ( Releasing , _               , Done                    ) => Finish                    , Start     ;
        5: ( Releasing , _               , Error | Joystick | Lost ) => PassUp                    , Start     ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = release_tool(step, s.held, s.emove);
    Choice { table: &RELEASE_TOOL, row, action, step: next.code() }
}
