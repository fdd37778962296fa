//! POSITION (V.4.1).

use rcs_core::{Plain, handshake::Lower, old_table, table::Decision};

use super::{Action, Choice, Holding, Situation};

/// Reference action of POSITION.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// The held object is being released.
    Releasing,
    /// The robot is on its way.
    Moving,
}

old_table! {
    /// POSITION (V.4.1): release what is held, then move to the position, with the parameters of a virtual
    /// object if one is named.
    pub POSITION: fn position(step: Step, holding: Holding, subtask: Lower) -> (Action, Step) {
        //    step                 holding        subtask                    action     next
        1: ( Start              , Held | Other , _                       ) => Release  , Releasing ;
        2: ( Start              , NotHeld      , _                       ) => Position , Moving    ;
        3: ( Releasing          , _            , Pending | Executing     ) => Wait     , Releasing ;
        4: ( Releasing          , _            , Done                    ) => Position , Moving    ;
        5: ( Moving             , _            , Pending | Executing     ) => Wait     , Moving    ;
        6: ( Moving             , _            , Done                    ) => Finish   , Start     ;
        7: ( Releasing | Moving , _            , Error | Joystick | Lost ) => PassUp   , Start     ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = position(step, s.holding, s.subtask);
    Choice { table: &POSITION, row, action, step: next.code() }
}
