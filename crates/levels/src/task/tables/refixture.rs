//! REFIXTURE (V.4.1).

use rcs_core::{Plain, handshake::Lower, old_table, table::Decision};

use super::{Action, Choice, Grips, Holding, Situation};

/// Reference action of REFIXTURE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// The gripper is being fetched.
    Gripper,
    /// The object is being fetched.
    Object,
    /// It is being regripped on the pedestal.
    Regripping,
    /// It is on its way to the destination.
    Moving,
}

old_table! {
    /// REFIXTURE (V.4.1): take an object, reorient it with the Active Pedestal, and hold it at the
    /// destination. An object that is held already, as after ACQUIRE, is not fetched.
    pub REFIXTURE: fn refixture(step: Step, holding: Holding, grips: Grips, subtask: Lower) -> (Action, Step) {
        //     step                                    holding           grips       subtask                    action          next
        1:  ( Start                                  , NotHeld | Other , _         , _                       ) => GetEndeff     , Gripper    ;
        2:  ( Start                                  , Held            , _         , _                       ) => GetObject     , Object     ;
        3:  ( Gripper                                , _               , _         , Pending | Executing     ) => Wait          , Gripper    ;
        4:  ( Gripper                                , _               , _         , Done                    ) => GetObject     , Object     ;
        5:  ( Object                                 , _               , _         , Pending | Executing     ) => Wait          , Object     ;
        6:  ( Object                                 , _               , Different , Done                    ) => FixGrip       , Regripping ;
        7:  ( Object                                 , _               , Same      , Done                    ) => MoveObjToDest , Moving     ;
        8:  ( Regripping                             , _               , _         , Pending | Executing     ) => Wait          , Regripping ;
        9:  ( Regripping                             , _               , _         , Done                    ) => MoveObjToDest , Moving     ;
        10: ( Moving                                 , _               , _         , Pending | Executing     ) => Wait          , Moving     ;
        11: ( Moving                                 , _               , _         , Done                    ) => Finish        , Start      ;
        12: ( Gripper | Object | Regripping | Moving , _               , _         , Error | Joystick | Lost ) => PassUp        , Start      ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = refixture(step, s.holding, s.grips, s.subtask);
    Choice { table: &REFIXTURE, row, action, step: next.code() }
}
