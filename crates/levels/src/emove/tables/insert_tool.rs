//! INSERT-TOOL (V.2.1).

use rcs_core::{Plain, handshake::Lower, interface::Reason, old_table, table::Decision};

use super::{Action, Choice, Held, Situation, Station};
use crate::emove::relative::Relative::{InsIn, InsNear};

/// Reference action of INSERT-TOOL.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// The tool is moving to the drum.
    Approaching,
    /// The force sensor is being calibrated.
    Calibrating,
    /// The tool is moving into the drum.
    Inserting,
}

old_table! {
    /// INSERT-TOOL (V.2.1): DELTA-MOVE, CAL-SENSOR, and a GO-WHILE that the insertion force ends. Done at
    /// once if the tool is in the drum.
    pub INSERT_TOOL: fn insert_tool(step: Step, station: Station, held: Held, prim: Lower) -> (Action, Step) {
        //     step                                   station             held              Prim                       action                      next
        1:  ( Start                                 , _                 , Nothing | Other , _                       ) => Fail(Reason::NothingHeld) , Start       ;
        2:  ( Start                                 , InDrum            , Right           , _                       ) => Finish                    , Start       ;
        3:  ( Start                                 , Elsewhere | There , Right           , _                       ) => DeltaMove(InsNear)        , Approaching ;
        4:  ( Approaching | Calibrating | Inserting , _                 , Nothing | Other , _                       ) => FailLost                  , Start       ;
        5:  ( Approaching | Calibrating | Inserting , _                 , Right           , Error | Joystick | Lost ) => PassUp                    , Start       ;
        6:  ( Approaching                           , _                 , Right           , Pending | Executing     ) => Wait                      , Approaching ;
        7:  ( Approaching                           , _                 , Right           , Done                    ) => CalSensor                 , Calibrating ;
        8:  ( Calibrating                           , _                 , Right           , Pending | Executing     ) => Wait                      , Calibrating ;
        9:  ( Calibrating                           , _                 , Right           , Done                    ) => GoWhile(InsIn)            , Inserting   ;
        10: ( Inserting                             , _                 , Right           , Pending | Executing     ) => Wait                      , Inserting   ;
        11: ( Inserting                             , _                 , Right           , Done                    ) => StandInDrum               , Start       ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = insert_tool(step, s.station, s.held, s.prim);
    Choice { table: &INSERT_TOOL, row, action, step: next.code() }
}
