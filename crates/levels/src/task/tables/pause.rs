//! PAUSE (V.4.1).

use rcs_core::{Plain, handshake::Lower, old_table, table::Decision};

use super::{Action, Choice, Situation};

/// Reference action of PAUSE.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Nothing done yet.
    Start,
    /// Subtask is pausing.
    Pausing,
}

old_table! {
    /// PAUSE (V.4.1): do nothing; the pause goes down the ladder.
    pub PAUSE: fn pause(step: Step, subtask: Lower) -> (Action, Step) {
        //    step      subtask                    action   next
        1: ( Start   , _                       ) => Pause  , Pausing ;
        2: ( Pausing , Pending | Executing     ) => Wait   , Pausing ;
        3: ( Pausing , Done                    ) => Finish , Start   ;
        4: ( Pausing , Error | Joystick | Lost ) => PassUp , Start   ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = pause(step, s.subtask);
    Choice { table: &PAUSE, row, action, step: next.code() }
}
