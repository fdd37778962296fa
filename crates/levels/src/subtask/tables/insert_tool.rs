//! INSERT-TOOL (V.3.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, interface::Reason, table::Decision};

use super::{Action, Choice, Held, Situation};

coded_enum! {
    /// Reference action of INSERT-TOOL.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// E-move is inserting the tool.
        Inserting = "inserting",
    }
}

decision_table! {
    /// INSERT-TOOL (V.3.1): insert a tool into the tool drum. The gripper holds it until RELEASE-TOOL.
    pub INSERT_TOOL: fn insert_tool(step: Step, held: Held, emove: Lower) -> (Action, Step) {
        //    step        held              E-move                     action                     next
        1: ( Start     , Right           , _                       ) => InsertTool                , Inserting ;
        2: ( Start     , Nothing | Other , _                       ) => Fail(Reason::NothingHeld) , Start     ;
        3: ( Inserting , _               , Pending | Executing     ) => Wait                      , Inserting ;
        4: ( Inserting , Right           , Done                    ) => Finish                    , Start     ;
        5: ( Inserting , Nothing | Other , Done                    ) => Fail(Reason::ObjectLost)  , Start     ;
        6: ( Inserting , _               , Error | Joystick | Lost ) => PassUp                    , Start     ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = insert_tool(step, s.held, s.emove);
    Choice { table: &INSERT_TOOL, row, action, step: next.code() }
}
