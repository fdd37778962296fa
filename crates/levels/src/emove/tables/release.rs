//! RELEASE (V.2.1).

use rcs_core::{Plain, handshake::Lower, old_table, table::Decision};

use super::{Action, Choice, Held, Situation, Spread};

/// Reference action of RELEASE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// The gripper is opening.
    Opening,
}

old_table! {
    /// RELEASE (V.2.1): open the gripper to the depart size; done at once if it is open and holds nothing.
    pub RELEASE: fn release(step: Step, held: Held, spread: Spread, gripper: Lower) -> (Action, Step) {
        //    step      held            spread   gripper                    action         next
        1: ( Start   , Nothing       , Open   , _                       ) => Finish       , Start   ;
        2: ( Start   , Nothing       , Narrow , _                       ) => OpenToDepart , Opening ;
        3: ( Start   , Right | Other , _      , _                       ) => OpenToDepart , Opening ;
        4: ( Opening , _             , _      , Pending | Executing     ) => Wait         , Opening ;
        5: ( Opening , _             , _      , Done                    ) => Finish       , Start   ;
        6: ( Opening , _             , _      , Error | Joystick | Lost ) => FailGrip     , Start   ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = release(step, s.held, s.spread, s.gripper);
    Choice { table: &RELEASE, row, action, step: next.code() }
}
