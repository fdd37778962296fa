//! REMOVE-TOOL (V.2.1).

use rcs_core::{Plain, handshake::Lower, interface::Reason, old_table, table::Decision};

use super::{Action, Choice, Held, Situation, Station};
use crate::emove::relative::Relative::RemOut;

/// Reference action of REMOVE-TOOL.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// The force sensor is being calibrated.
    Calibrating,
    /// The tool is being pulled out.
    Removing,
}

old_table! {
    /// REMOVE-TOOL (V.2.1): CAL-SENSOR and a guarded move that the extraction force ends: a GO-WHILE, though
    /// the manual says GO-UNTIL, for the force is what must not come
    /// (SPECNOTES.md, contradiction 18). Done at once if the
    /// tool is out.
    pub REMOVE_TOOL: fn remove_tool(step: Step, station: Station, held: Held, prim: Lower) -> (Action, Step) {
        //     step                     station     held              Prim                       action                      next
        1:  ( Start                  , _         , Nothing | Other , _                       ) => Fail(Reason::NothingHeld) , Start       ;
        2:  ( Start                  , There     , Right           , _                       ) => Finish                    , Start       ;
        3:  ( Start                  , Elsewhere , Right           , _                       ) => Fail(Reason::NotPrepared) , Start       ;
        4:  ( Start                  , InDrum    , Right           , _                       ) => CalSensor                 , Calibrating ;
        5:  ( Calibrating | Removing , _         , Nothing | Other , _                       ) => FailLost                  , Start       ;
        6:  ( Calibrating | Removing , _         , Right           , Error | Joystick | Lost ) => PassUp                    , Start       ;
        7:  ( Calibrating            , _         , Right           , Pending | Executing     ) => Wait                      , Calibrating ;
        8:  ( Calibrating            , _         , Right           , Done                    ) => GoWhile(RemOut)           , Removing    ;
        9:  ( Removing               , _         , Right           , Pending | Executing     ) => Wait                      , Removing    ;
        10: ( Removing               , _         , Right           , Done                    ) => Stand                     , Start       ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = remove_tool(step, s.station, s.held, s.prim);
    Choice { table: &REMOVE_TOOL, row, action, step: next.code() }
}
