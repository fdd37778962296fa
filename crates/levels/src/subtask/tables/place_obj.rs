//! PLACE-OBJ (V.3.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, interface::Reason, table::Decision};

use super::{Action, Choice, GripHeld, Held, Situation};

coded_enum! {
    /// Reference action of PLACE-OBJ.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// The object is on its way.
        Moving = "moving",
        /// The gripper is opening.
        Releasing = "releasing",
    }
}

decision_table! {
    /// PLACE-OBJ (V.3.1): move an object to a location and release it. E-move reports an object that is lost
    /// on the way.
    pub PLACE_OBJ: fn place_obj(step: Step, held: Held, grip: GripHeld, emove: Lower) -> (Action, Step) {
        //    step                 held              grip                    E-move                     action                      next
        1: ( Start              , Right           , Destination | Unknown , _                       ) => MovObjTo                   , Moving    ;
        2: ( Start              , Right           , Source | Neither      , _                       ) => Fail(Reason::RegripNeeded) , Start     ;
        3: ( Start              , Nothing | Other , _                     , _                       ) => Fail(Reason::NothingHeld)  , Start     ;
        4: ( Moving             , _               , _                     , Pending | Executing     ) => Wait                       , Moving    ;
        5: ( Moving             , Right           , _                     , Done                    ) => Release                    , Releasing ;
        6: ( Moving             , Nothing | Other , _                     , Done                    ) => Fail(Reason::ObjectLost)   , Start     ;
        7: ( Releasing          , _               , _                     , Pending | Executing     ) => Wait                       , Releasing ;
        8: ( Releasing          , _               , _                     , Done                    ) => Finish                     , Start     ;
        9: ( Moving | Releasing , _               , _                     , Error | Joystick | Lost ) => PassUp                     , Start     ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = place_obj(step, s.held, s.grip, s.emove);
    Choice { table: &PLACE_OBJ, row, action, step: next.code() }
}
