//! QC-DETACH (V.2.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, interface::Reason, table::Decision};

use super::{Action, Choice, Detection, Held, Holster, Mate, Ring, Situation, Station};
use crate::emove::relative::Relative::{QcdDown, QcdSeat, QcdUp};

coded_enum! {
    /// Reference action of QC-DETACH.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// The gripper is moving down into the holster.
        Lowering = "lowering",
        /// The quick change is unlocking; the gripper drops.
        Unlocking = "unlocking",
        /// The gripper is being pushed to its seat.
        Seating = "seating",
        /// The robot is moving up out of the gripper.
        Rising = "rising",
    }
}

decision_table! {
    /// QC-DETACH (V.2.1): down until the large sensors of the holster see the ears, unlock, forward until the small ones see them, up,
    /// and check that the gripper stayed there. Done at once if it is there.
    pub QC_DETACH: fn qc_detach(step: Step, station: Station, held: Held, mate: Mate, holster: Holster, ring: Ring, detection: Detection, prim: Lower) -> (Action, Step) {
        //     step                                      station             held            mate            holster           ring                      detection Prim                        action                          next
        1:  ( Start                                   , _                 , _             , None          , Full            , _                      , _       , _                        ) => Finish                        , Start     ;
        2:  ( Start                                   , _                 , _             , None          , Empty | Partial , _                      , _       , _                        ) => Fail(Reason::WrongGripper)    , Start     ;
        3:  ( Start                                   , _                 , _             , Wrong         , _               , _                      , _       , _                        ) => Fail(Reason::WrongGripper)    , Start     ;
        4:  ( Start                                   , Elsewhere | InDrum , _            , Right         , _               , _                      , _       , _                        ) => Fail(Reason::NotPrepared)     , Start     ;
        5:  ( Start                                   , There             , Right | Other , Right         , _               , _                      , _       , _                        ) => Fail(Reason::AlreadyHolding)  , Start     ;
        6:  ( Start                                   , There             , Nothing       , Right         , Partial | Full  , _                      , _       , _                        ) => Fail(Reason::HolsterOccupied) , Start     ;
        7:  ( Start                                   , There             , Nothing       , Right         , Empty           , _                      , _       , _                        ) => GoUntil(QcdDown)              , Lowering  ;
        8:  ( Lowering | Unlocking | Seating | Rising , _                 , _             , _             , _               , _                      , _       , Error | Joystick | Lost  ) => PassUp                        , Start     ;
        9:  ( Lowering                                , _                 , _             , _             , _               , _                      , Awaited , Pending | Executing      ) => Wait                          , Lowering  ;
        10: ( Lowering | Seating                      , _                 , _             , _             , _               , _                      , Overdue , Pending | Executing      ) => Fail(Reason::NotDetected)     , Start     ;
        11: ( Lowering                                , _                 , _             , _             , _               , _                      , _       , Done                     ) => Unlock                        , Unlocking ;
        12: ( Unlocking                               , _                 , _             , _             , _               , Busy                   , _       , Pending | Executing | Done ) => Wait                        , Unlocking ;
        13: ( Unlocking                               , _                 , _             , _             , _               , Locked | Faulty        , _       , Pending | Executing | Done ) => FailRing                    , Start     ;
        14: ( Unlocking                               , _                 , _             , _             , _               , Unlocked               , _       , Pending | Executing | Done ) => GoUntil(QcdSeat)            , Seating   ;
        15: ( Seating                                 , _                 , _             , _             , _               , _                      , Awaited , Pending | Executing      ) => Wait                          , Seating   ;
        16: ( Seating                                 , _                 , _             , _             , _               , _                      , _       , Done                     ) => DeltaMove(QcdUp)              , Rising    ;
        17: ( Rising                                  , _                 , _             , _             , _               , _                      , _       , Pending | Executing      ) => Wait                          , Rising    ;
        18: ( Rising                                  , _                 , _             , Right | Wrong , _               , _                      , _       , Done                     ) => Fail(Reason::NotDetached)     , Start     ;
        19: ( Rising                                  , _                 , _             , None          , Empty | Partial , _                      , _       , Done                     ) => Fail(Reason::NotDetached)     , Start     ;
        20: ( Rising                                  , _                 , _             , None          , Full            , Busy | Locked | Faulty , _       , Done                     ) => FailRing                      , Start     ;
        21: ( Rising                                  , _                 , _             , None          , Full            , Unlocked               , _       , Done                     ) => Stand                         , Start     ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } =
        qc_detach(step, s.station, s.held, s.mate, s.holster, s.ring, s.detection, s.prim);
    Choice { table: &QC_DETACH, row, action, step: next.code() }
}
