//! RELEASE (V.3.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, table::Decision};

use super::{Action, Choice, Situation};

coded_enum! {
    /// Reference action of RELEASE.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// The gripper is opening.
        Releasing = "releasing",
    }
}

decision_table! {
    /// RELEASE (V.3.1): open the gripper and release what it holds.
    pub RELEASE: fn release(step: Step, emove: Lower) -> (Action, Step) {
        //    step        E-move                     action    next
        1: ( Start     , _                       ) => Release , Releasing ;
        2: ( Releasing , Pending | Executing     ) => Wait    , Releasing ;
        3: ( Releasing , Done                    ) => Finish  , Start     ;
        4: ( Releasing , Error | Joystick | Lost ) => PassUp  , Start     ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = release(step, s.emove);
    Choice { table: &RELEASE, row, action, step: next.code() }
}
