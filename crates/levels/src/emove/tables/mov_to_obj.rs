//! MOV-TO-OBJ and MOV-TO-VU (V.2.1).

use rcs_core::{decision_table, handshake::Lower, table::Decision};

use super::{Action, Ahead, Choice, Motion, Opening, Situation};

decision_table! {
    /// MOV-TO-OBJ, MOV-TO-VU (V.2.1): like MOV-TO-LOC, with the fingers opened for the goal once the last depart point is behind; the
    /// final motion waits for them.
    pub MOV_TO_OBJ: fn mov_to_obj(step: Motion, ahead: Ahead, opening: Opening, prim: Lower) -> (Action, Motion) {
        //     step               ahead            opening                        Prim                       action     next
        1:  ( _                , _              , Failed                       , _                       ) => FailGrip , Start    ;
        2:  ( _                , _              , Set | Departing | Due | Moving, Error | Joystick | Lost ) => PassUp   , Start    ;
        3:  ( Start | Moving   , _              , Set | Departing | Due | Moving, Pending | Executing     ) => Wait     , Moving   ;
        4:  ( Start | Moving   , _              , Due                          , Done                    ) => Open     , Moving   ;
        5:  ( Start | Moving   , Through        , Set | Departing | Moving     , Done                    ) => GoThru   , Moving   ;
        6:  ( Start | Moving   , Stop | Nothing , Departing | Moving           , Done                    ) => Wait     , Moving   ;
        7:  ( Start | Moving   , Stop           , Set                          , Done                    ) => GotoPt   , Stopping ;
        8:  ( Start | Moving   , Nothing        , Set                          , Done                    ) => Arrive   , Start    ;
        9:  ( Stopping         , _              , Set | Departing | Due | Moving, Pending | Executing     ) => Wait     , Stopping ;
        10: ( Stopping         , _              , Set | Departing | Due | Moving, Done                    ) => Arrive   , Start    ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Motion::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = mov_to_obj(step, s.ahead, s.opening, s.prim);
    Choice { table: &MOV_TO_OBJ, row, action, step: next.code() }
}
