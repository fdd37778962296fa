//! MOV-OBJ-TO (V.2.1).

use rcs_core::{handshake::Lower, interface::Reason, old_table, table::Decision};

use super::{Action, Ahead, Choice, Held, Motion, Situation};

old_table! {
    /// MOV-OBJ-TO (V.2.1): move the held object to a destination. An object that is lost on the way stops the
    /// robot.
    pub MOV_OBJ_TO: fn mov_obj_to(step: Motion, held: Held, ahead: Ahead, prim: Lower) -> (Action, Motion) {
        //     step                 held              ahead     Prim                       action                      next
        1:  ( Start              , Nothing | Other , _       , _                       ) => Fail(Reason::NothingHeld) , Start    ;
        2:  ( Moving | Stopping  , Nothing | Other , _       , _                       ) => FailLost                  , Start    ;
        3:  ( _                  , Right           , _       , Error | Joystick | Lost ) => PassUp                    , Start    ;
        4:  ( Start | Moving     , Right           , _       , Pending | Executing     ) => Wait                      , Moving   ;
        5:  ( Start | Moving     , Right           , Through , Done                    ) => GoThru                    , Moving   ;
        6:  ( Start | Moving     , Right           , Stop    , Done                    ) => GotoPt                    , Stopping ;
        7:  ( Start | Moving     , Right           , Nothing , Done                    ) => Arrive                    , Start    ;
        8:  ( Stopping           , Right           , _       , Pending | Executing     ) => Wait                      , Stopping ;
        9:  ( Stopping           , Right           , _       , Done                    ) => Arrive                    , Start    ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Motion::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = mov_obj_to(step, s.held, s.ahead, s.prim);
    Choice { table: &MOV_OBJ_TO, row, action, step: next.code() }
}
