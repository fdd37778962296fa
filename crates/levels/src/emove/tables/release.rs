//! RELEASE (V.2.1).

use rcs_core::{coded_enum, decision_table, handshake::Lower, table::Decision};

use super::{Action, Choice, Situation};

coded_enum! {
    /// Reference action of RELEASE.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
        /// The gripper is opening.
        Opening = "opening",
    }
}

decision_table! {
    /// RELEASE (V.2.1): open the gripper to the depart size.
    pub RELEASE: fn release(step: Step, grip: Lower) -> (Action, Step) {
        //    step      Grip                       action         next
        1: ( Start   , _                       ) => OpenToDepart , Opening ;
        2: ( Opening , Pending | Executing     ) => Wait         , Opening ;
        3: ( Opening , Done                    ) => Released     , Start   ;
        4: ( Opening , Error | Joystick | Lost ) => FailGrip     , Start   ;
    }
}

pub(super) fn consult(step: u8, s: &Situation) -> Choice {
    let step = Step::from_code(step).unwrap_or_default();
    let Decision { row, action, next } = release(step, s.grip);
    Choice { table: &RELEASE, row, action, step: next.code() }
}
