//! QC-DETACH (V.2.1).

use rcs_core::{Plain, interface::Reason, old_table, table::Decision};

use super::{Action, Choice, Held, Holster, Mate, Ring, Situation, Station, Travel};
use crate::emove::relative::Relative::{QcdDown, QcdSeat, QcdUp};

/// Reference action of QC-DETACH.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// The gripper is moving down into the holster.
    Lowering,
    /// The quick change is unlocking; the gripper drops.
    Unlocking,
    /// The gripper is being pushed to its seat.
    Seating,
    /// The robot is moving up out of the gripper.
    Rising,
}

old_table! {
    /// QC-DETACH (V.2.1): down until the large sensors of the holster see the ears, unlock, forward until the
    /// small ones see them, up, and check that the gripper stayed there. Done at once if it is there.
    pub QC_DETACH: fn qc_detach(step: Step, station: Station, held: Held, mate: Mate, holster: Holster, ring: Ring, travel: Travel) -> (Action, Step) {
        //     step                                      station              held            mate            holster           ring                     travel                        action                          next
        1:  ( Start                                   , _                  , _             , None          , Full            , _                      , _                        ) => Finish                        , Start     ;
        2:  ( Start                                   , _                  , _             , None          , Empty | Partial , _                      , _                        ) => Fail(Reason::WrongGripper)    , Start     ;
        3:  ( Start                                   , _                  , _             , Wrong         , _               , _                      , _                        ) => Fail(Reason::WrongGripper)    , Start     ;
        4:  ( Start                                   , Elsewhere | InDrum , _             , Right         , _               , _                      , _                        ) => Fail(Reason::NotPrepared)     , Start     ;
        5:  ( Start                                   , There              , Right | Other , Right         , _               , _                      , _                        ) => Fail(Reason::AlreadyHolding)  , Start     ;
        6:  ( Start                                   , There              , Nothing       , Right         , Partial | Full  , _                      , _                        ) => Fail(Reason::HolsterOccupied) , Start     ;
        7:  ( Start                                   , There              , Nothing       , Right         , Empty           , _                      , _                        ) => GoUntil(QcdDown)              , Lowering  ;
        8:  ( Lowering                                , _                  , _             , _             , _               , _                      , UnderWay                 ) => Wait                          , Lowering  ;
        9:  ( Lowering                                , _                  , _             , _             , _               , _                      , Over                     ) => Unlock                        , Unlocking ;
        10: ( Unlocking                               , _                  , _             , _             , _               , Busy                   , UnderWay | Missed | Over ) => Wait                          , Unlocking ;
        11: ( Unlocking                               , _                  , _             , _             , _               , Locked | Faulty        , UnderWay | Missed | Over ) => FailRing                      , Start     ;
        12: ( Unlocking                               , _                  , _             , _             , _               , Unlocked               , UnderWay | Missed | Over ) => GoUntil(QcdSeat)              , Seating   ;
        13: ( Seating                                 , _                  , _             , _             , _               , _                      , UnderWay                 ) => Wait                          , Seating   ;
        14: ( Seating                                 , _                  , _             , _             , _               , _                      , Over                     ) => DeltaMove(QcdUp)              , Rising    ;
        15: ( Lowering | Seating                      , _                  , _             , _             , _               , _                      , Missed                   ) => Fail(Reason::NotDetected)     , Start     ;
        16: ( Rising                                  , _                  , _             , _             , _               , _                      , UnderWay | Missed        ) => Wait                          , Rising    ;
        17: ( Rising                                  , _                  , _             , Right | Wrong , _               , _                      , Over                     ) => Fail(Reason::NotDetached)     , Start     ;
        18: ( Rising                                  , _                  , _             , None          , Empty | Partial , _                      , Over                     ) => Fail(Reason::NotDetached)     , Start     ;
        19: ( Rising                                  , _                  , _             , None          , Full            , Busy | Locked | Faulty , Over                     ) => FailRing                      , Start     ;
        20: ( Rising                                  , _                  , _             , None          , Full            , Unlocked               , Over                     ) => Stand                         , Start     ;
        21: ( Lowering | Unlocking | Seating | Rising , _                  , _             , _             , _               , _                      , Failed                   ) => PassUp                        , Start     ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } =
        qc_detach(step, s.station, s.held, s.mate, s.holster, s.ring, s.travel);
    Choice { table: &QC_DETACH, row, action, step: next.code() }
}
