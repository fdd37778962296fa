//! PAUSE (V.4.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, table::Decision};

use super::{Action, Choice, Situation};

coded_enum! {
    /// Reference action of PAUSE.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// Subtask is pausing.
        Pausing = "pausing",
    }
}

decision_table! {
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
