//! FIX-GRIP (V.3.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, interface::Reason, table::Decision};

use super::{Action, Choice, GripHeld, Hand, Held, Pedestal, Situation};

coded_enum! {
    /// Reference action of FIX-GRIP.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// The pedestal opens its hand and turns its table to receive the object.
        Preparing = "preparing",
        /// The object is on its way to the pedestal.
        Bringing = "bringing",
        /// The pedestal closes its hand on the object.
        Gripping = "gripping",
        /// The robot lets go.
        Releasing = "releasing",
        /// The robot is on its way out of the pedestal's way.
        Clearing = "clearing",
        /// The pedestal turns the object.
        Flipping = "flipping",
        /// The robot is on its way back to the object.
        Approaching = "approaching",
        /// The robot's fingers are closing.
        Grasping = "grasping",
        /// The pedestal lets go.
        LettingGo = "letting-go",
    }
}

decision_table! {
    /// FIX-GRIP (V.3.1): regrip the object with the Active Pedestal; done at once if it is held as it is to
    /// be. While anything is wrong with the pedestal the robot stays where it is and keeps its grip.
    pub FIX_GRIP: fn fix_grip(step: Step, held: Held, grip: GripHeld, emove: Lower, pedestal: Pedestal, hand: Hand) -> (Action, Step) {
        //     step                                                      held              grip               E-move                     pedestal   hand          action                                      next
        1:  ( Start                                                   , Nothing | Other , _                , _                       , _        , _        ) => Fail(Reason::NothingHeld)                , Start       ;
        2:  ( Start                                                   , Right           , Destination      , _                       , _        , _        ) => Finish                                   , Start       ;
        3:  ( Start                                                   , Right           , Neither          , _                       , _        , _        ) => Fail(Reason::RegripNeeded)               , Start       ;
        4:  ( Start                                                   , Right           , Source | Unknown , _                       , _        , _        ) => PedPreGrip                               , Preparing   ;
        5:  ( Preparing                                               , _               , _                , _                       , Moving   , _        ) => Wait                                     , Preparing   ;
        6:  ( Preparing                                               , Right           , _                , _                       , Done     , _        ) => MovObjToPed                              , Bringing    ;
        7:  ( Preparing                                               , Nothing | Other , _                , _                       , Done     , _        ) => Fail(Reason::ObjectLost)                 , Start       ;
        8:  ( Bringing                                                , _               , _                , Pending | Executing     , _        , _        ) => Wait                                     , Bringing    ;
        9:  ( Bringing                                                , Right           , _                , Done                    , _        , _        ) => PedGrip                                  , Gripping    ;
        10: ( Bringing                                                , Nothing | Other , _                , Done                    , _        , _        ) => Fail(Reason::ObjectLost)                 , Start       ;
        11: ( Gripping                                                , _               , _                , _                       , Moving   , _        ) => Wait                                     , Gripping    ;
        12: ( Gripping                                                , _               , _                , _                       , Done     , Gripping ) => ReleaseAtPed                             , Releasing   ;
        13: ( Gripping                                                , _               , _                , _                       , Done     , Empty    ) => Fail(Reason::GraspMissed)                , Start       ;
        14: ( Releasing                                               , _               , _                , Pending | Executing     , _        , _        ) => Wait                                     , Releasing   ;
        15: ( Releasing                                               , _               , _                , Done                    , _        , _        ) => MovToPedSafe                             , Clearing    ;
        16: ( Clearing                                                , _               , _                , Pending | Executing     , _        , _        ) => Wait                                     , Clearing    ;
        17: ( Clearing                                                , _               , _                , Done                    , _        , _        ) => PedFlip                                  , Flipping    ;
        18: ( Flipping                                                , _               , _                , _                       , Moving   , _        ) => Wait                                     , Flipping    ;
        19: ( Flipping                                                , _               , _                , _                       , Done     , Gripping ) => MovToObjAtPed                            , Approaching ;
        20: ( Flipping                                                , _               , _                , _                       , Done     , Empty    ) => Fail(Reason::ObjectLost)                 , Start       ;
        21: ( Approaching                                             , _               , _                , Pending | Executing     , _        , _        ) => Wait                                     , Approaching ;
        22: ( Approaching                                             , _               , _                , Done                    , _        , _        ) => GraspObjAtPed                            , Grasping    ;
        23: ( Grasping                                                , _               , _                , Pending | Executing     , _        , _        ) => Wait                                     , Grasping    ;
        24: ( Grasping                                                , Right           , _                , Done                    , _        , _        ) => PedRelease                               , LettingGo   ;
        25: ( Grasping                                                , Nothing | Other , _                , Done                    , _        , _        ) => Fail(Reason::GraspMissed)                , Start       ;
        26: ( LettingGo                                               , _               , _                , _                       , Moving   , _        ) => Wait                                     , LettingGo   ;
        27: ( LettingGo                                               , Right           , _                , _                       , Done     , _        ) => Finish                                   , Start       ;
        28: ( LettingGo                                               , Nothing | Other , _                , _                       , Done     , _        ) => Fail(Reason::ObjectLost)                 , Start       ;
        29: ( Preparing | Gripping | Flipping | LettingGo             , _               , _                , _                       , Cannot   , _        ) => PassUpPedestal(Reason::PedestalCannot)   , Start       ;
        30: ( Preparing | Gripping | Flipping | LettingGo             , _               , _                , _                       , Faulty   , _        ) => PassUpPedestal(Reason::PedestalError)    , Start       ;
        31: ( Preparing | Gripping | Flipping | LettingGo             , _               , _                , _                       , Silent   , _        ) => PassUpPedestal(Reason::PedestalSilent)   , Start       ;
        32: ( Bringing | Releasing | Clearing | Approaching | Grasping, _               , _                , Error | Joystick | Lost , _        , _        ) => PassUp                                   , Start       ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = fix_grip(step, s.held, s.grip, s.emove, s.pedestal, s.hand);
    Choice { table: &FIX_GRIP, row, action, step: next.code() }
}
