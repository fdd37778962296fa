//! LOCATE-OBJ (V.2.1).

use rcs_core::{Plain, handshake::Lower, interface::Reason, old_table, table::Decision};

use super::{Action, Choice, Sight, Situation, Tries};

/// Reference action of LOCATE-OBJ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// The fast flood picture is being taken.
    Flooding,
    /// The camera is moving over the centroid.
    Centring,
    /// The second picture is being taken.
    Measuring,
    /// The camera is moving over the part, and turning with it.
    Aligning,
}

old_table! {
    /// LOCATE-OBJ (V.2.1): a fast flood picture, centre the camera over it, a second picture with recognition
    /// and angle, align.
    pub LOCATE_OBJ: fn locate_obj(step: Step, sight: Sight, tries: Tries, prim: Lower) -> (Action, Step) {
        //     step                   sight                                  tries   Prim                         action                          next
        1:  ( Start                , _                                    , _     , _                       ) => Flood                          , Flooding  ;
        2:  ( Flooding             , Waiting                              , _     , _                       ) => Wait                           , Flooding  ;
        3:  ( Flooding             , Seen                                 , _     , _                       ) => Centre                         , Centring  ;
        4:  ( Flooding             , Missing | Unrecognised | Implausible , Left  , _                       ) => FloodAgain                     , Flooding  ;
        5:  ( Flooding             , Missing | Unrecognised               , Spent , _                       ) => Fail(Reason::NothingSeen)      , Start     ;
        6:  ( Flooding | Measuring , Silent                               , _     , _                       ) => Fail(Reason::VisionSilent)     , Start     ;
        7:  ( Centring             , _                                    , _     , Pending | Executing     ) => Wait                           , Centring  ;
        8:  ( Centring             , _                                    , _     , Done                    ) => Precise                        , Measuring ;
        9:  ( Measuring            , Waiting                              , _     , _                       ) => Wait                           , Measuring ;
        10: ( Measuring            , Seen                                 , _     , _                       ) => Align                          , Aligning  ;
        11: ( Measuring            , Missing | Unrecognised | Implausible , Left  , _                       ) => PreciseAgain                   , Measuring ;
        12: ( Measuring            , Missing                              , Spent , _                       ) => Fail(Reason::NothingSeen)      , Start     ;
        13: ( Measuring            , Unrecognised                         , Spent , _                       ) => Fail(Reason::NotRecognised)    , Start     ;
        14: ( Aligning             , _                                    , _     , Pending | Executing     ) => Wait                           , Aligning  ;
        15: ( Aligning             , _                                    , _     , Done                    ) => Located                        , Start     ;
        16: ( Centring | Aligning  , _                                    , _     , Error | Joystick | Lost ) => PassUp                         , Start     ;
        17: ( Flooding | Measuring , Implausible                          , Spent , _                       ) => Fail(Reason::VisionImplausible), Start     ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = locate_obj(step, s.sight, s.tries, s.prim);
    Choice { table: &LOCATE_OBJ, row, action, step: next.code() }
}
