//! RELEASE-TOOL (V.4.1).

use rcs_core::{Plain, handshake::Lower, interface::Reason, old_table, table::Decision};

use super::{Action, Choice, Ends, Situation, Station, Tool};

/// Reference action of RELEASE-TOOL.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// The tool is being let go.
    Releasing,
    /// The robot is on its way to the end-at location.
    Leaving,
}

old_table! {
    /// RELEASE-TOOL (V.4.1): let go of a tool in the transfer location, then go to the end-at location; done
    /// at once if that is so.
    pub RELEASE_TOOL: fn release_tool(step: Step, tool: Tool, station: Station, ends: Ends, subtask: Lower) -> (Action, Step) {
        //     step                  tool   station            ends                subtask                    action                     next
        1:  ( Start               , Held , Transfer         , _                 , _                       ) => ReleaseTool               , Releasing ;
        2:  ( Start               , Held , Safe | Elsewhere , _                 , _                       ) => Fail(Reason::NotPrepared) , Start     ;
        3:  ( Start               , Free , _                , There             , _                       ) => Finish                    , Start     ;
        4:  ( Start               , Free , _                , Here | Elsewhere  , _                       ) => Fail(Reason::NotPrepared) , Start     ;
        5:  ( Start               , None , _                , _                 , _                       ) => Fail(Reason::NotPrepared) , Start     ;
        6:  ( Releasing           , _    , _                , _                 , Pending | Executing     ) => Wait                      , Releasing ;
        7:  ( Releasing           , _    , _                , There | Elsewhere , Done                    ) => GotoEndpt                 , Leaving   ;
        8:  ( Releasing           , _    , _                , Here              , Done                    ) => Finish                    , Start     ;
        9:  ( Leaving             , _    , _                , _                 , Pending | Executing     ) => Wait                      , Leaving   ;
        10: ( Leaving             , _    , _                , _                 , Done                    ) => Finish                    , Start     ;
        11: ( Releasing | Leaving , _    , _                , _                 , Error | Joystick | Lost ) => PassUp                    , Start     ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = release_tool(step, s.tool, s.station, s.ends, s.subtask);
    Choice { table: &RELEASE_TOOL, row, action, step: next.code() }
}
