//! QC-ATTACH (V.2.1).

use rcs_core::{Plain, interface::Reason, old_table, table::Decision};

use super::{Action, Choice, Holster, Mate, Readiness, Ring, Situation, Station, Travel};
use crate::emove::relative::Relative::{QcaBack, QcaFast, QcaLift, QcaSlow, QcaUp};

/// Reference action of QC-ATTACH.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// The quick change of the bare robot is unlocking.
    Unlocking,
    /// The robot is moving close to the gripper.
    Approaching,
    /// It is moving slowly onto the gripper.
    Mating,
    /// The quick change is locking.
    Locking,
    /// The gripper is closing.
    Closing,
    /// The gripper is sliding back out of its seat.
    Backing,
    /// It is being lifted a distance out of the holster.
    Lifting,
    /// It is being lifted completely out of it.
    Raising,
    /// It is being calibrated.
    Calibrating,
}

old_table! {
    /// QC-ATTACH (V.2.1): down fast, down slowly, lock, close the gripper, back, lift, check the id, up,
    /// calibrate if required. Done at once if the gripper is locked on and clear of its holster. A bare robot
    /// whose ring is locked is unlocked first.
    pub QC_ATTACH: fn qc_attach(step: Step, station: Station, mate: Mate, holster: Holster, ring: Ring, readiness: Readiness, travel: Travel) -> (Action, Step) {
        //     step                                       station              mate    holster           ring                       readiness               travel                        action                         next
        1:  ( Start                                    , _                  , Right , Empty           , Locked                   , _                     , _                        ) => Finish                       , Start       ;
        2:  ( Start                                    , _                  , Right , Empty           , Busy | Unlocked | Faulty , _                     , _                        ) => FailRing                     , Start       ;
        3:  ( Start                                    , _                  , Right , Partial | Full  , _                        , _                     , _                        ) => Fail(Reason::NotPrepared)    , Start       ;
        4:  ( Start                                    , _                  , Wrong , _               , _                        , _                     , _                        ) => Fail(Reason::WrongGripper)   , Start       ;
        5:  ( Start                                    , Elsewhere | InDrum , None  , _               , _                        , _                     , _                        ) => Fail(Reason::NotPrepared)    , Start       ;
        6:  ( Start                                    , There              , None  , Empty | Partial , _                        , _                     , _                        ) => Fail(Reason::HolsterEmpty)   , Start       ;
        7:  ( Start                                    , There              , None  , Full            , Busy                     , _                     , _                        ) => Wait                         , Start       ;
        8:  ( Start                                    , There              , None  , Full            , Faulty                   , _                     , _                        ) => FailRing                     , Start       ;
        9:  ( Start                                    , There              , None  , Full            , Locked                   , _                     , _                        ) => Unlock                       , Unlocking   ;
        10: ( Start                                    , There              , None  , Full            , Unlocked                 , _                     , _                        ) => DeltaMove(QcaFast)           , Approaching ;
        11: ( Unlocking                                , _                  , _     , _               , Busy                     , _                     , _                        ) => Wait                         , Unlocking   ;
        12: ( Unlocking                                , _                  , _     , _               , Locked | Faulty          , _                     , _                        ) => FailRing                     , Start       ;
        13: ( Unlocking                                , _                  , _     , _               , Unlocked                 , _                     , _                        ) => DeltaMove(QcaFast)           , Approaching ;
        14: ( Approaching                              , _                  , _     , _               , _                        , _                     , UnderWay | Missed        ) => Wait                         , Approaching ;
        15: ( Approaching                              , _                  , _     , _               , _                        , _                     , Over                     ) => DeltaMove(QcaSlow)           , Mating      ;
        16: ( Mating                                   , _                  , _     , _               , _                        , _                     , UnderWay | Missed        ) => Wait                         , Mating      ;
        17: ( Mating                                   , _                  , _     , _               , _                        , _                     , Over                     ) => Lock                         , Locking     ;
        18: ( Locking                                  , _                  , _     , _               , Busy                     , _                     , UnderWay | Missed | Over ) => Wait                         , Locking     ;
        19: ( Locking                                  , _                  , _     , _               , Unlocked | Faulty        , _                     , UnderWay | Missed | Over ) => FailRing                     , Start       ;
        20: ( Locking                                  , _                  , _     , _               , Locked                   , _                     , UnderWay | Missed | Over ) => CloseForHolster              , Closing     ;
        21: ( Closing                                  , _                  , _     , _               , _                        , Busy                  , UnderWay | Missed | Over ) => Wait                         , Closing     ;
        22: ( Closing                                  , _                  , _     , _               , _                        , Faulty                , UnderWay | Missed | Over ) => FailGrip                     , Start       ;
        23: ( Closing                                  , _                  , _     , _               , _                        , Ready | Raw           , UnderWay | Missed | Over ) => DeltaMove(QcaBack)           , Backing     ;
        24: ( Backing                                  , _                  , _     , _               , _                        , _                     , UnderWay | Missed        ) => Wait                         , Backing     ;
        25: ( Backing                                  , _                  , _     , _               , _                        , _                     , Over                     ) => DeltaMove(QcaLift)           , Lifting     ;
        26: ( Lifting                                  , _                  , _     , _               , _                        , _                     , UnderWay | Missed        ) => Wait                         , Lifting     ;
        27: ( Lifting | Raising                        , _                  , None  , _               , _                        , _                     , Over                     ) => Fail(Reason::NotAttached)    , Start       ;
        28: ( Lifting | Raising                        , _                  , Wrong , _               , _                        , _                     , Over                     ) => Fail(Reason::WrongGripperId) , Start       ;
        29: ( Lifting                                  , _                  , Right , _               , Busy | Unlocked | Faulty , _                     , Over                     ) => FailRing                     , Start       ;
        30: ( Lifting                                  , _                  , Right , _               , Locked                   , _                     , Over                     ) => DeltaMove(QcaUp)             , Raising     ;
        31: ( Raising                                  , _                  , _     , _               , _                        , _                     , UnderWay | Missed        ) => Wait                         , Raising     ;
        32: ( Raising                                  , _                  , Right , _               , _                        , Raw                   , Over                     ) => Calibrate                    , Calibrating ;
        33: ( Raising                                  , _                  , Right , _               , _                        , Ready                 , Over                     ) => Stand                        , Start       ;
        34: ( Raising                                  , _                  , Right , _               , _                        , Busy | Faulty         , Over                     ) => FailGrip                     , Start       ;
        35: ( Approaching | Mating | Locking | Closing , _                  , _     , _               , _                        , _                     , Failed                   ) => PassUp                       , Start       ;
        36: ( Backing | Lifting | Raising              , _                  , _     , _               , _                        , _                     , Failed                   ) => PassUp                       , Start       ;
        37: ( Calibrating                              , _                  , _     , _               , _                        , Busy                  , _                        ) => Wait                         , Calibrating ;
        38: ( Calibrating                              , _                  , _     , _               , _                        , Raw | Faulty          , _                        ) => FailGrip                     , Start       ;
        39: ( Calibrating                              , _                  , _     , _               , _                        , Ready                 , _                        ) => Stand                        , Start       ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } =
        qc_attach(step, s.station, s.mate, s.holster, s.ring, s.readiness, s.travel);
    Choice { table: &QC_ATTACH, row, action, step: next.code() }
}
