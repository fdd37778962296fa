//! `>POSITION` (V.3.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, table::Decision};

use super::{Action, Choice, Named, Situation};

coded_enum! {
    /// Reference action of `>POSITION`.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// The robot is on its way.
        Moving = "moving",
    }
}

decision_table! {
    /// >POSITION (V.3.1): move to a position with the parameters of an object, which may be a virtual one.
    pub POSITION: fn position(step: Step, named: Named, emove: Lower) -> (Action, Step) {
        //    step     named      E-move                     action     next
        1: ( Start  , Object   , _                       ) => MovToObj , Moving ;
        2: ( Start  , Location , _                       ) => MovToLoc , Moving ;
        3: ( Moving , _        , Pending | Executing     ) => Wait     , Moving ;
        4: ( Moving , _        , Done                    ) => Finish   , Start  ;
        5: ( Moving , _        , Error | Joystick | Lost ) => PassUp   , Start  ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = position(step, s.named, s.emove);
    Choice { table: &POSITION, row, action, step: next.code() }
}
