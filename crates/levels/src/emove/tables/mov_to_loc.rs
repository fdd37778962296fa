//! MOV-TO-LOC (V.2.1).

use rcs_core::{decision_table, handshake::Lower, table::Decision};

use super::{Action, Ahead, Choice, Motion, Situation};

decision_table! {
    /// MOV-TO-LOC (V.2.1): a series of GO-THRU and one GOTO-PT; no gripper commands.
    pub MOV_TO_LOC: fn mov_to_loc(step: Motion, ahead: Ahead, prim: Lower) -> (Action, Motion) {
        //    step               ahead     Prim                       action   next
        1: ( _                , _       , Error | Joystick | Lost ) => PassUp , Start    ;
        2: ( Start | Moving   , _       , Pending | Executing     ) => Wait   , Moving   ;
        3: ( Start | Moving   , Through , Done                    ) => GoThru , Moving   ;
        4: ( Start | Moving   , Stop    , Done                    ) => GotoPt , Stopping ;
        5: ( Start | Moving   , Nothing , Done                    ) => Arrive , Start    ;
        6: ( Stopping         , _       , Pending | Executing     ) => Wait   , Stopping ;
        7: ( Stopping         , _       , Done                    ) => Arrive , Start    ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Motion::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = mov_to_loc(step, s.ahead, s.prim);
    Choice { table: &MOV_TO_LOC, row, action, step: next.code() }
}
