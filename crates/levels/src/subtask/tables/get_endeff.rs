//! GET-ENDEFF (V.3.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, interface::Reason, table::Decision};

use super::{Action, Choice, Gripper, Held, Holster, Situation};

coded_enum! {
    /// Reference action of GET-ENDEFF.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// The robot is on its way to the holster of the gripper that it has.
        Stowing = "stowing",
        /// The gripper is being left in its holster.
        Detaching = "detaching",
        /// The bare robot is on its way to the holster of the wanted gripper.
        Fetching = "fetching",
        /// The wanted gripper is being taken.
        Attaching = "attaching",
    }
}

decision_table! {
    /// GET-ENDEFF (V.3.1): connect the proper gripper; done at once if it is on. A gripper that holds
    /// something is not left.
    pub GET_ENDEFF: fn get_endeff(step: Step, gripper: Gripper, held: Held, emove: Lower) -> (Action, Step) {
        //     step                                           gripper         held            E-move                     action                         next
        1:  ( Start                                        , Right         , _             , _                       ) => Finish                       , Start     ;
        2:  ( Start                                        , Wrong         , Right | Other , _                       ) => Fail(Reason::AlreadyHolding) , Start     ;
        3:  ( Start                                        , Wrong         , Nothing       , _                       ) => MovToHol(Holster::Own)       , Stowing   ;
        4:  ( Start                                        , None          , _             , _                       ) => MovToHol(Holster::Wanted)    , Fetching  ;
        5:  ( Stowing                                      , _             , _             , Pending | Executing     ) => Wait                         , Stowing   ;
        6:  ( Stowing                                      , _             , _             , Done                    ) => QcDetach                     , Detaching ;
        7:  ( Detaching                                    , _             , _             , Pending | Executing     ) => Wait                         , Detaching ;
        8:  ( Detaching                                    , None          , _             , Done                    ) => MovToHol(Holster::Wanted)    , Fetching  ;
        9:  ( Detaching                                    , Right | Wrong , _             , Done                    ) => Fail(Reason::NotDetached)    , Start     ;
        10: ( Fetching                                     , _             , _             , Pending | Executing     ) => Wait                         , Fetching  ;
        11: ( Fetching                                     , _             , _             , Done                    ) => QcAttach                     , Attaching ;
        12: ( Attaching                                    , _             , _             , Pending | Executing     ) => Wait                         , Attaching ;
        13: ( Attaching                                    , Right         , _             , Done                    ) => Finish                       , Start     ;
        14: ( Attaching                                    , Wrong         , _             , Done                    ) => Fail(Reason::WrongGripperId) , Start     ;
        15: ( Attaching                                    , None          , _             , Done                    ) => Fail(Reason::NotAttached)    , Start     ;
        16: ( Stowing | Detaching | Fetching | Attaching   , _             , _             , Error | Joystick | Lost ) => PassUp                       , Start     ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = get_endeff(step, s.gripper, s.held, s.emove);
    Choice { table: &GET_ENDEFF, row, action, step: next.code() }
}
