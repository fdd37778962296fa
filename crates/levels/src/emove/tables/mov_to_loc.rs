//! MOV-TO-LOC (V.2.1).

use rcs_core::{handshake::Lower, old_table, table::Decision};

use super::{Action, Ahead, Choice, Load, Motion, Situation};

old_table! {
    /// MOV-TO-LOC (V.2.1): a series of GO-THRU and one GOTO-PT; no gripper commands. What the robot carries
    /// must not be lost.
    pub MOV_TO_LOC: fn mov_to_loc(step: Motion, load: Load, ahead: Ahead, prim: Lower) -> (Action, Motion) {
        //    step               load   ahead     Prim                       action                     next
        1: ( _                , Lost , _       , _                       ) => FailLost                 , Start    ;
        2: ( _                , Kept , _       , Error | Joystick | Lost ) => PassUp                   , Start    ;
        3: ( Start | Moving   , Kept , _       , Pending | Executing     ) => Wait                     , Moving   ;
        4: ( Start | Moving   , Kept , Through , Done                    ) => GoThru                   , Moving   ;
        5: ( Start | Moving   , Kept , Stop    , Done                    ) => GotoPt                   , Stopping ;
        6: ( Start | Moving   , Kept , Nothing , Done                    ) => Arrive                   , Start    ;
        7: ( Stopping         , Kept , _       , Pending | Executing     ) => Wait                     , Stopping ;
        8: ( Stopping         , Kept , _       , Done                    ) => Arrive                   , Start    ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Motion::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = mov_to_loc(step, s.load, s.ahead, s.prim);
    Choice { table: &MOV_TO_LOC, row, action, step: next.code() }
}
