//! RELEASE-TOOL (V.2.1).

use rcs_core::{Plain, handshake::Lower, interface::Reason, old_table, table::Decision};

use super::{Action, Choice, Held, Situation, Spread, Station, Travel};
use crate::emove::relative::Relative::{RelBack, RelSlide};

/// Reference action of RELEASE-TOOL.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// The gripper is opening.
    Opening,
    /// The force sensor is being calibrated.
    Calibrating,
    /// The gripper is sliding to the right.
    Sliding,
    /// The robot is pulling back.
    Withdrawing,
}

old_table! {
    /// RELEASE-TOOL (V.2.1): open the tool gripper, calibrate, slide to the right until the strike plate
    /// gives a moment, pull back. Done at once by who stands before the drum with open fingers and nothing in
    /// them.
    pub RELEASE_TOOL: fn release_tool(step: Step, station: Station, held: Held, spread: Spread, gripper: Lower, travel: Travel) -> (Action, Step) {
        //     step                                  station     held            spread   gripper                   travel                 action                      next
        1:  ( Start                               , InDrum    , _             , _      , _                       , _                 ) => OpenToDepart              , Opening     ;
        2:  ( Start                               , There     , Nothing       , Open   , _                       , _                 ) => Finish                    , Start       ;
        3:  ( Start                               , There     , Nothing       , Narrow , _                       , _                 ) => Fail(Reason::NotPrepared) , Start       ;
        4:  ( Start                               , There     , Right | Other , _      , _                       , _                 ) => Fail(Reason::NotPrepared) , Start       ;
        5:  ( Start                               , Elsewhere , _             , _      , _                       , _                 ) => Fail(Reason::NotPrepared) , Start       ;
        6:  ( Opening                             , _         , _             , _      , Pending | Executing     , _                 ) => Wait                      , Opening     ;
        7:  ( Opening                             , _         , _             , _      , Error | Joystick | Lost , _                 ) => FailGrip                  , Start       ;
        8:  ( Opening                             , _         , _             , _      , Done                    , _                 ) => CalSensor                 , Calibrating ;
        9:  ( Calibrating                         , _         , _             , _      , _                       , UnderWay | Missed ) => Wait                      , Calibrating ;
        10: ( Calibrating                         , _         , _             , _      , _                       , Over              ) => GoUntil(RelSlide)         , Sliding     ;
        11: ( Sliding                             , _         , _             , _      , _                       , UnderWay          ) => Wait                      , Sliding     ;
        12: ( Sliding                             , _         , _             , _      , _                       , Missed            ) => Fail(Reason::NotDetected) , Start       ;
        13: ( Sliding                             , _         , _             , _      , _                       , Over              ) => DeltaMove(RelBack)        , Withdrawing ;
        14: ( Withdrawing                         , _         , _             , _      , _                       , UnderWay | Missed ) => Wait                      , Withdrawing ;
        15: ( Withdrawing                         , _         , _             , _      , _                       , Over              ) => Stand                     , Start       ;
        16: ( Calibrating | Sliding | Withdrawing , _         , _             , _      , _                       , Failed            ) => PassUp                    , Start       ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = release_tool(step, s.station, s.held, s.spread, s.gripper, s.travel);
    Choice { table: &RELEASE_TOOL, row, action, step: next.code() }
}
