//! MOV-TO-HOL (V.2.1).

use rcs_core::{handshake::Lower, interface::Reason, old_table, table::Decision};

use super::{Action, Ahead, Choice, Held, Motion, Opening, Situation};

old_table! {
    /// MOV-TO-HOL (V.2.1): move to a holster; the gripper, if one is attached, closes to the value of the
    /// holster object on the way. A gripper that holds an object cannot do that.
    pub MOV_TO_HOL: fn mov_to_hol(step: Motion, held: Held, ahead: Ahead, opening: Opening, prim: Lower) -> (Action, Motion) {
        //     step               held            ahead            opening                         Prim                       action                         next
        1:  ( Start            , Right | Other , _              , _                             , _                       ) => Fail(Reason::AlreadyHolding) , Start    ;
        2:  ( _                , _             , _              , Failed                        , _                       ) => FailGrip                     , Start    ;
        3:  ( _                , _             , _              , Set | Departing | Due | Moving , Error | Joystick | Lost ) => PassUp                       , Start    ;
        4:  ( Start | Moving   , _             , _              , Set | Departing | Due | Moving , Pending | Executing     ) => Wait                         , Moving   ;
        5:  ( Start | Moving   , _             , _              , Due                           , Done                    ) => Open                         , Moving   ;
        6:  ( Start | Moving   , _             , Through        , Set | Departing | Moving      , Done                    ) => GoThru                       , Moving   ;
        7:  ( Start | Moving   , _             , Stop | Nothing , Departing | Moving            , Done                    ) => Wait                         , Moving   ;
        8:  ( Start | Moving   , _             , Stop           , Set                           , Done                    ) => GotoPt                       , Stopping ;
        9:  ( Start | Moving   , _             , Nothing        , Set                           , Done                    ) => Arrive                       , Start    ;
        10: ( Stopping         , _             , _              , Set | Departing | Due | Moving , Pending | Executing     ) => Wait                         , Stopping ;
        11: ( Stopping         , _             , _              , Set | Departing | Due | Moving , Done                    ) => Arrive                       , Start    ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Motion::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = mov_to_hol(step, s.held, s.ahead, s.opening, s.prim);
    Choice { table: &MOV_TO_HOL, row, action, step: next.code() }
}
