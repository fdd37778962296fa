//! INSERT-TOOL (V.4.1).

use rcs_core::{Plain, handshake::Lower, interface::Reason, old_table, table::Decision};

use super::{Action, Choice, Situation, Station, Tool};

/// Reference action of INSERT-TOOL.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// The tool is being inserted.
    Inserting,
}

old_table! {
    /// INSERT-TOOL (V.4.1): insert a tool, which a MOVE has brought near the tool drum, into the drum; done
    /// at once if it is there.
    pub INSERT_TOOL: fn insert_tool(step: Step, tool: Tool, station: Station, subtask: Lower) -> (Action, Step) {
        //    step        tool          station     subtask                    action                     next
        1: ( Start     , Held        , Transfer  , _                       ) => Finish                    , Start     ;
        2: ( Start     , Held        , Safe      , _                       ) => InsertTool                , Inserting ;
        3: ( Start     , Held        , Elsewhere , _                       ) => Fail(Reason::NotPrepared) , Start     ;
        4: ( Start     , Free | None , _         , _                       ) => Fail(Reason::NotPrepared) , Start     ;
        5: ( Inserting , _           , _         , Pending | Executing     ) => Wait                      , Inserting ;
        6: ( Inserting , _           , _         , Done                    ) => Finish                    , Start     ;
        7: ( Inserting , _           , _         , Error | Joystick | Lost ) => PassUp                    , Start     ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = insert_tool(step, s.tool, s.station, s.subtask);
    Choice { table: &INSERT_TOOL, row, action, step: next.code() }
}
