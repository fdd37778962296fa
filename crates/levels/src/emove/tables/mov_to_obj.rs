//! MOV-TO-OBJ and MOV-TO-VU (V.2.1).

use rcs_core::{handshake::Lower, interface::Reason, old_table, table::Decision};

use super::{Action, Ahead, Choice, Held, Motion, Opening, Situation};

old_table! {
    /// MOV-TO-OBJ, MOV-TO-VU (V.2.1): like MOV-TO-LOC, with the fingers opened for the goal once the last
    /// depart point is behind; the final motion waits for them. Who holds the object is at it; who holds
    /// another must not open the fingers.
    pub MOV_TO_OBJ: fn mov_to_obj(step: Motion, held: Held, ahead: Ahead, opening: Opening, prim: Lower) -> (Action, Motion) {
        //     step               held    ahead            opening                         Prim                       action                         next
        1:  ( Start            , Right , _              , _                             , _                       ) => Finish                       , Start    ;
        2:  ( Start            , Other , _              , _                             , _                       ) => Fail(Reason::AlreadyHolding) , Start    ;
        3:  ( _                , _     , _              , Failed                        , _                       ) => FailGrip                     , Start    ;
        4:  ( _                , _     , _              , Set | Departing | Due | Moving , Error | Joystick | Lost ) => PassUp                       , Start    ;
        5:  ( Start | Moving   , _     , _              , Set | Departing | Due | Moving , Pending | Executing     ) => Wait                         , Moving   ;
        6:  ( Start | Moving   , _     , _              , Due                           , Done                    ) => Open                         , Moving   ;
        7:  ( Start | Moving   , _     , Through        , Set | Departing | Moving      , Done                    ) => GoThru                       , Moving   ;
        8:  ( Start | Moving   , _     , Stop | Nothing , Departing | Moving            , Done                    ) => Wait                         , Moving   ;
        9:  ( Start | Moving   , _     , Stop           , Set                           , Done                    ) => GotoPt                       , Stopping ;
        10: ( Start | Moving   , _     , Nothing        , Set                           , Done                    ) => Arrive                       , Start    ;
        11: ( Stopping         , _     , _              , Set | Departing | Due | Moving , Pending | Executing     ) => Wait                         , Stopping ;
        12: ( Stopping         , _     , _              , Set | Departing | Due | Moving , Done                    ) => Arrive                       , Start    ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Motion::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = mov_to_obj(step, s.held, s.ahead, s.opening, s.prim);
    Choice { table: &MOV_TO_OBJ, row, action, step: next.code() }
}
