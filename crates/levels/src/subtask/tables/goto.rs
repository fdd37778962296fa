//! GOTO-ENDPT and GOTO-DEST (V.3.1): one table, the location is in the command.

use rcs_core::{coded_enum, decision_table, handshake::Lower, table::Decision};

use super::{Action, Choice, Situation};

coded_enum! {
    /// Reference action of GOTO-ENDPT and GOTO-DEST.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// The robot is on its way.
        Moving = "moving",
    }
}

decision_table! {
    /// GOTO-ENDPT, GOTO-DEST (V.3.1): move to the end-at location, or to the destination.
    pub GOTO: fn goto(step: Step, emove: Lower) -> (Action, Step) {
        //    step     E-move                     action     next
        1: ( Start  , _                       ) => MovToLoc , Moving ;
        2: ( Moving , Pending | Executing     ) => Wait     , Moving ;
        3: ( Moving , Done                    ) => Finish   , Start  ;
        4: ( Moving , Error | Joystick | Lost ) => PassUp   , Start  ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = goto(step, s.emove);
    Choice { table: &GOTO, row, action, step: next.code() }
}
