//! REMOVE-TOOL (V.4.1).

use rcs_core::{Plain, handshake::Lower, interface::Reason, old_table, table::Decision};

use super::{Action, Choice, Ends, Situation, Station, Tool};

/// Reference action of REMOVE-TOOL.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// The tool is being pulled out.
    Removing,
    /// The robot is on its way to the end-at location.
    Leaving,
}

old_table! {
    /// REMOVE-TOOL (V.4.1): pull a tool that has been acquired out of the tool drum, then go to the end-at
    /// location; done at once if the tool is there.
    pub REMOVE_TOOL: fn remove_tool(step: Step, tool: Tool, station: Station, ends: Ends, subtask: Lower) -> (Action, Step) {
        //     step                 tool          station            ends                subtask                    action                     next
        1:  ( Start              , Held        , Transfer         , _                 , _                       ) => RemoveTool                , Removing ;
        2:  ( Start              , Held        , Safe | Elsewhere , There             , _                       ) => Finish                    , Start    ;
        3:  ( Start              , Held        , Safe | Elsewhere , Here | Elsewhere  , _                       ) => Fail(Reason::NotPrepared) , Start    ;
        4:  ( Start              , Free | None , _                , _                 , _                       ) => Fail(Reason::NotPrepared) , Start    ;
        5:  ( Removing           , _           , _                , _                 , Pending | Executing     ) => Wait                      , Removing ;
        6:  ( Removing           , _           , _                , There | Elsewhere , Done                    ) => GotoEndpt                 , Leaving  ;
        7:  ( Removing           , _           , _                , Here              , Done                    ) => Finish                    , Start    ;
        8:  ( Leaving            , _           , _                , _                 , Pending | Executing     ) => Wait                      , Leaving  ;
        9:  ( Leaving            , _           , _                , _                 , Done                    ) => Finish                    , Start    ;
        10: ( Removing | Leaving , _           , _                , _                 , Error | Joystick | Lost ) => PassUp                    , Start    ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = remove_tool(step, s.tool, s.station, s.ends, s.subtask);
    Choice { table: &REMOVE_TOOL, row, action, step: next.code() }
}
