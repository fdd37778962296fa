//! S-PAUSE (V.3.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, table::Decision};

use super::{Action, Choice, Situation};

coded_enum! {
    /// Reference action of S-PAUSE.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// E-move is pausing.
        Pausing = "pausing",
    }
}

decision_table! {
    /// S-PAUSE (V.3.1): do nothing; the pause goes down the ladder.
    pub S_PAUSE: fn s_pause(step: Step, emove: Lower) -> (Action, Step) {
        //    step      E-move                     action   next
        1: ( Start   , _                       ) => Pause  , Pausing ;
        2: ( Pausing , Pending | Executing     ) => Wait   , Pausing ;
        3: ( Pausing , Done                    ) => Finish , Start   ;
        4: ( Pausing , Error | Joystick | Lost ) => PassUp , Start   ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = s_pause(step, s.emove);
    Choice { table: &S_PAUSE, row, action, step: next.code() }
}
