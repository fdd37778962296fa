//! GET-OBJECT (V.3.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, interface::Reason, table::Decision};

use super::{Action, Choice, Held, Situation, Vision};

coded_enum! {
    /// Reference action of GET-OBJECT.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// The robot is on its way to where the picture is taken.
        Viewing = "viewing",
        /// Vision is looking for the object.
        Locating = "locating",
        /// The robot is on its way to the object.
        Moving = "moving",
        /// The gripper is closing.
        Grasping = "grasping",
    }
}

decision_table! {
    /// GET-OBJECT (V.3.1): find the object if vision is needed, move to it and grasp it; done at once if it
    /// is held.
    pub GET_OBJECT: fn get_object(step: Step, held: Held, vision: Vision, emove: Lower) -> (Action, Step) {
        //     step                                        held              vision      E-move                     action                        next
        1:  ( Start                                     , Right           , _         , _                       ) => Finish                       , Start    ;
        2:  ( Start                                     , Other           , _         , _                       ) => Fail(Reason::AlreadyHolding) , Start    ;
        3:  ( Start                                     , Nothing         , Needed    , _                       ) => MovToVu                      , Viewing  ;
        4:  ( Start                                     , Nothing         , NotNeeded , _                       ) => MovToObj                     , Moving   ;
        5:  ( Viewing                                   , _               , _         , Pending | Executing     ) => Wait                         , Viewing  ;
        6:  ( Viewing                                   , _               , _         , Done                    ) => LocateObj                    , Locating ;
        7:  ( Locating                                  , _               , _         , Pending | Executing     ) => Wait                         , Locating ;
        8:  ( Locating                                  , _               , _         , Done                    ) => MovToObj                     , Moving   ;
        9:  ( Moving                                    , _               , _         , Pending | Executing     ) => Wait                         , Moving   ;
        10: ( Moving                                    , _               , _         , Done                    ) => GraspObj                     , Grasping ;
        11: ( Grasping                                  , _               , _         , Pending | Executing     ) => Wait                         , Grasping ;
        12: ( Grasping                                  , Right           , _         , Done                    ) => Finish                       , Start    ;
        13: ( Grasping                                  , Nothing | Other , _         , Done                    ) => Fail(Reason::GraspMissed)    , Start    ;
        14: ( Viewing | Locating | Moving | Grasping    , _               , _         , Error | Joystick | Lost ) => PassUp                       , Start    ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = get_object(step, s.held, s.vision, s.emove);
    Choice { table: &GET_OBJECT, row, action, step: next.code() }
}
