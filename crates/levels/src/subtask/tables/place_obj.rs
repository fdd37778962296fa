//! PLACE-OBJ (V.3.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, interface::Reason, table::Decision};

use super::{Action, Choice, Held, Situation};

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
    /// PLACE-OBJ (V.3.1): move an object to a location and release it. E-move reports an object that is lost on the way.
    pub PLACE_OBJ: fn place_obj(step: Step, held: Held, emove: Lower) -> (Action, Step) {
        //    step                 held              E-move                     action                     next
        1: ( Start              , Right           , _                       ) => MovObjTo                  , Moving    ;
        2: ( Start              , Nothing | Other , _                       ) => Fail(Reason::NothingHeld) , Start     ;
        3: ( Moving             , _               , Pending | Executing     ) => Wait                      , Moving    ;
        4: ( Moving             , Right           , Done                    ) => Release                   , Releasing ;
        5: ( Moving             , Nothing | Other , Done                    ) => Fail(Reason::ObjectLost)  , Start     ;
        6: ( Releasing          , _               , Pending | Executing     ) => Wait                      , Releasing ;
        7: ( Releasing          , _               , Done                    ) => Finish                    , Start     ;
        8: ( Moving | Releasing , _               , Error | Joystick | Lost ) => PassUp                    , Start     ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = place_obj(step, s.held, s.emove);
    Choice { table: &PLACE_OBJ, row, action, step: next.code() }
}
