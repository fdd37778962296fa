//! PAUSE (V.1.1), without the Joystick Box.

use rcs_core::{coded_enum, decision_table, table::Decision};

use super::{Action, Choice, Posture, Situation};

coded_enum! {
    /// Reference action of PAUSE.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// The robot ramps down.
        Stopping = "stopping",
    }
}

decision_table! {
    /// PAUSE (V.1.1): do nothing. A motion ramps down within its limits; then the last point is repeated.
    pub PAUSE: fn pause(step: Step, posture: Posture) -> (Action, Step) {
        //    step       posture                     action   next
        1: ( _        , Unpositioned | Standing ) => Finish , Start    ;
        2: ( Start    , Moving | Ending         ) => Halt   , Stopping ;
        3: ( Stopping , Moving | Ending         ) => Wait   , Stopping ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = pause(step, s.posture);
    Choice { table: &PAUSE, row, action, step: next.code() }
}
