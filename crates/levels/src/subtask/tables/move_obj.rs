//! MOVE-OBJ>D (V.3.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, interface::Reason, table::Decision};

use super::{Action, Choice, GripHeld, Held, Situation};

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
    pub MOVE_OBJ_TO_DEST: fn move_obj_to_dest(step: Step, held: Held, grip: GripHeld, emove: Lower) -> (Action, Step) {
        //    step     held              grip                    E-move                     action                      next
        1: ( Start  , Right           , Destination | Unknown , _                       ) => MovObjTo                   , Moving ;
        2: ( Start  , Right           , Source | Neither      , _                       ) => Fail(Reason::RegripNeeded) , Start  ;
        3: ( Start  , Nothing | Other , _                     , _                       ) => Fail(Reason::NothingHeld)  , Start  ;
        4: ( Moving , _               , _                     , Pending | Executing     ) => Wait                       , Moving ;
        5: ( Moving , Right           , _                     , Done                    ) => Finish                     , Start  ;
        6: ( Moving , Nothing | Other , _                     , Done                    ) => Fail(Reason::ObjectLost)   , Start  ;
        7: ( Moving , _               , _                     , Error | Joystick | Lost ) => PassUp                     , Start  ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = move_obj_to_dest(step, s.held, s.grip, s.emove);
    Choice { table: &MOVE_OBJ_TO_DEST, row, action, step: next.code() }
}
