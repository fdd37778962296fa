//! QC-ATTACH (V.2.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, interface::Reason, table::Decision};

use super::{Action, Calibration, Choice, Holster, Mate, Ring, Situation, Station};
use crate::emove::relative::Relative::{QcaBack, QcaFast, QcaLift, QcaSlow, QcaUp};

coded_enum! {
    /// Reference action of QC-ATTACH.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// The quick change of the bare robot is unlocking.
        Unlocking = "unlocking",
        /// The robot is moving close to the gripper.
        Approaching = "approaching",
        /// It is moving slowly onto the gripper.
        Mating = "mating",
        /// The quick change is locking.
        Locking = "locking",
        /// The gripper is closing.
        Closing = "closing",
        /// The gripper is sliding back out of its seat.
        Backing = "backing",
        /// It is being lifted a distance out of the holster.
        Lifting = "lifting",
        /// It is being lifted completely out of it.
        Raising = "raising",
        /// It is being calibrated.
        Calibrating = "calibrating",
    }
}

decision_table! {
    /// QC-ATTACH (V.2.1): down fast, down slowly, lock, close the gripper, back, lift, check the id, up, calibrate if required. Done at
    /// once if the gripper is locked on and clear of its holster. A bare robot whose ring is locked is unlocked first.
    pub QC_ATTACH: fn qc_attach(step: Step, station: Station, mate: Mate, holster: Holster, ring: Ring, gripper: Lower, calibration: Calibration, prim: Lower) -> (Action, Step) {
        //     step                                       station               mate           holster           ring                        gripper                    calibr.   Prim                          action                         next
        1:  ( Start                                    , _                  , Right        , Empty           , Locked                   , _                       , _       , _                          ) => Finish                       , Start       ;
        2:  ( Start                                    , _                  , Right        , Empty           , Busy | Unlocked | Faulty , _                       , _       , _                          ) => FailRing                     , Start       ;
        3:  ( Start                                    , _                  , Right        , Partial | Full  , _                        , _                       , _       , _                          ) => Fail(Reason::NotPrepared)    , Start       ;
        4:  ( Start                                    , _                  , Wrong        , _               , _                        , _                       , _       , _                          ) => Fail(Reason::WrongGripper)   , Start       ;
        5:  ( Start                                    , Elsewhere | InDrum , None         , _               , _                        , _                       , _       , _                          ) => Fail(Reason::NotPrepared)    , Start       ;
        6:  ( Start                                    , There              , None         , Empty | Partial , _                        , _                       , _       , _                          ) => Fail(Reason::HolsterEmpty)   , Start       ;
        7:  ( Start                                    , There              , None         , Full            , Busy                     , _                       , _       , _                          ) => Wait                         , Start       ;
        8:  ( Start                                    , There              , None         , Full            , Faulty                   , _                       , _       , _                          ) => FailRing                     , Start       ;
        9:  ( Start                                    , There              , None         , Full            , Locked                   , _                       , _       , _                          ) => Unlock                       , Unlocking   ;
        10: ( Start                                    , There              , None         , Full            , Unlocked                 , _                       , _       , _                          ) => DeltaMove(QcaFast)           , Approaching ;
        11: ( Unlocking                                , _                  , _            , _               , Busy                     , _                       , _       , _                          ) => Wait                         , Unlocking   ;
        12: ( Unlocking                                , _                  , _            , _               , Locked | Faulty          , _                       , _       , _                          ) => FailRing                     , Start       ;
        13: ( Unlocking                                , _                  , _            , _               , Unlocked                 , _                       , _       , _                          ) => DeltaMove(QcaFast)           , Approaching ;
        14: ( Approaching | Mating | Locking | Closing , _                  , _            , _               , _                        , _                       , _       , Error | Joystick | Lost    ) => PassUp                       , Start       ;
        15: ( Backing | Lifting | Raising              , _                  , _            , _               , _                        , _                       , _       , Error | Joystick | Lost    ) => PassUp                       , Start       ;
        16: ( Approaching                              , _                  , _            , _               , _                        , _                       , _       , Pending | Executing        ) => Wait                         , Approaching ;
        17: ( Approaching                              , _                  , _            , _               , _                        , _                       , _       , Done                       ) => DeltaMove(QcaSlow)           , Mating      ;
        18: ( Mating                                   , _                  , _            , _               , _                        , _                       , _       , Pending | Executing        ) => Wait                         , Mating      ;
        19: ( Mating                                   , _                  , _            , _               , _                        , _                       , _       , Done                       ) => Lock                         , Locking     ;
        20: ( Locking                                  , _                  , _            , _               , Busy                     , _                       , _       , Pending | Executing | Done ) => Wait                         , Locking     ;
        21: ( Locking                                  , _                  , _            , _               , Unlocked | Faulty        , _                       , _       , Pending | Executing | Done ) => FailRing                     , Start       ;
        22: ( Locking                                  , _                  , _            , _               , Locked                   , _                       , _       , Pending | Executing | Done ) => CloseForHolster              , Closing     ;
        23: ( Closing                                  , _                  , _            , _               , _                        , Pending | Executing     , _       , Pending | Executing | Done ) => Wait                         , Closing     ;
        24: ( Closing                                  , _                  , _            , _               , _                        , Error | Joystick | Lost , _       , Pending | Executing | Done ) => FailGrip                     , Start       ;
        25: ( Closing                                  , _                  , _            , _               , _                        , Done                    , _       , Pending | Executing | Done ) => DeltaMove(QcaBack)           , Backing     ;
        26: ( Backing                                  , _                  , _            , _               , _                        , _                       , _       , Pending | Executing        ) => Wait                         , Backing     ;
        27: ( Backing                                  , _                  , _            , _               , _                        , _                       , _       , Done                       ) => DeltaMove(QcaLift)           , Lifting     ;
        28: ( Lifting                                  , _                  , _            , _               , _                        , _                       , _       , Pending | Executing        ) => Wait                         , Lifting     ;
        29: ( Lifting | Raising                        , _                  , None         , _               , _                        , _                       , _       , Done                       ) => Fail(Reason::NotAttached)    , Start       ;
        30: ( Lifting | Raising                        , _                  , Wrong        , _               , _                        , _                       , _       , Done                       ) => Fail(Reason::WrongGripperId) , Start       ;
        31: ( Lifting                                  , _                  , Right        , _               , Busy | Unlocked | Faulty , _                       , _       , Done                       ) => FailRing                     , Start       ;
        32: ( Lifting                                  , _                  , Right        , _               , Locked                   , _                       , _       , Done                       ) => DeltaMove(QcaUp)             , Raising     ;
        33: ( Raising                                  , _                  , _            , _               , _                        , _                       , _       , Pending | Executing        ) => Wait                         , Raising     ;
        34: ( Raising                                  , _                  , Right        , _               , _                        , _                       , Missing , Done                       ) => Calibrate                    , Calibrating ;
        35: ( Raising                                  , _                  , Right        , _               , _                        , _                       , Valid   , Done                       ) => Stand                        , Start       ;
        36: ( Calibrating                              , _                  , _            , _               , _                        , Pending | Executing     , _       , _                          ) => Wait                         , Calibrating ;
        37: ( Calibrating                              , _                  , _            , _               , _                        , Error | Joystick | Lost , _       , _                          ) => FailGrip                     , Start       ;
        38: ( Calibrating                              , _                  , _            , _               , _                        , Done                    , _       , _                          ) => Stand                        , Start       ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } =
        qc_attach(step, s.station, s.mate, s.holster, s.ring, s.gripper, s.calibration, s.prim);
    Choice { table: &QC_ATTACH, row, action, step: next.code() }
}
