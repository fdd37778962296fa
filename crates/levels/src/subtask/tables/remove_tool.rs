//! REMOVE-TOOL (V.3.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, interface::Reason, table::Decision};

use super::{Action, Choice, Held, Situation};

coded_enum! {
    /// Reference action of REMOVE-TOOL.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// E-move is pulling the tool out.
        Removing = "removing",
    }
}

decision_table! {
    /// REMOVE-TOOL (V.3.1): pull a tool that has been acquired out of the tool drum.
    pub REMOVE_TOOL: fn remove_tool(step: Step, held: Held, emove: Lower) -> (Action, Step) {
        //    step       held              E-move                     action                     next
        1: ( Start    , Right           , _                       ) => RemoveTool                , Removing ;
        2: ( Start    , Nothing | Other , _                       ) => Fail(Reason::NothingHeld) , Start    ;
        3: ( Removing , _               , Pending | Executing     ) => Wait                      , Removing ;
        4: ( Removing , Right           , Done                    ) => Finish                    , Start    ;
        5: ( Removing , Nothing | Other , Done                    ) => Fail(Reason::ObjectLost)  , Start    ;
        6: ( Removing , _               , Error | Joystick | Lost ) => PassUp                    , Start    ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = remove_tool(step, s.held, s.emove);
    Choice { table: &REMOVE_TOOL, row, action, step: next.code() }
}
