//! ACQUIRE (V.4.1).

use rcs_core::{Plain, handshake::Lower, old_table, table::Decision};

use super::{Action, Choice, Situation};

/// Reference action of ACQUIRE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// The gripper is being fetched.
    Gripper,
    /// The object is being fetched.
    Object,
}

old_table! {
    /// ACQUIRE (V.4.1): get the proper end effector, move to the object and grasp it.
    pub ACQUIRE: fn acquire(step: Step, subtask: Lower) -> (Action, Step) {
        //    step               subtask                    action      next
        1: ( Start            , _                       ) => GetEndeff , Gripper ;
        2: ( Gripper          , Pending | Executing     ) => Wait      , Gripper ;
        3: ( Gripper          , Done                    ) => GetObject , Object  ;
        4: ( Object           , Pending | Executing     ) => Wait      , Object  ;
        5: ( Object           , Done                    ) => Finish    , Start   ;
        6: ( Gripper | Object , Error | Joystick | Lost ) => PassUp    , Start   ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = acquire(step, s.subtask);
    Choice { table: &ACQUIRE, row, action, step: next.code() }
}
