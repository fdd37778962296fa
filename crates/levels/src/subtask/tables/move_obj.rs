//! MOVE-OBJ>D (V.3.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, interface::Reason, table::Decision};

use super::{Action, Choice, Held, Situation};

coded_enum! {
    /// Reference action of MOVE-OBJ>D.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// The object is on its way.
        Moving = "moving",
    }
}

decision_table! {
    /// MOVE-OBJ>D (V.3.1): move an object to the destination and hold it there.
    pub MOVE_OBJ_TO_DEST: fn move_obj_to_dest(step: Step, held: Held, emove: Lower) -> (Action, Step) {
        //    step     held              E-move                     action                     next
        1: ( Start  , Right           , _                       ) => MovObjTo                  , Moving ;
        2: ( Start  , Nothing | Other , _                       ) => Fail(Reason::NothingHeld) , Start  ;
        3: ( Moving , _               , Pending | Executing     ) => Wait                      , Moving ;
        4: ( Moving , Right           , Done                    ) => Finish                    , Start  ;
        5: ( Moving , Nothing | Other , Done                    ) => Fail(Reason::ObjectLost)  , Start  ;
        6: ( Moving , _               , Error | Joystick | Lost ) => PassUp                    , Start  ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = move_obj_to_dest(step, s.held, s.emove);
    Choice { table: &MOVE_OBJ_TO_DEST, row, action, step: next.code() }
}
