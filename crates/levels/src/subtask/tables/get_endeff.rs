//! GET-ENDEFF (V.3.1).

use rcs_core::{coded_enum, decision_table, interface::Reason, table::Decision};

use super::{Action, Choice, Gripper, Situation};

coded_enum! {
    /// Reference action of GET-ENDEFF: one step, since grippers are not exchanged yet.
    pub enum Step {
        /// Nothing done yet.
        Start = "start",
    }
}

decision_table! {
    /// GET-ENDEFF (V.3.1): connect the proper gripper; done at once if it is on.
    pub GET_ENDEFF: fn get_endeff(gripper: Gripper) -> (Action, Step) {
        //    gripper          action                      next
        1: ( Right        ) => Finish                     , Start ;
        2: ( Wrong | None ) => Fail(Reason::WrongGripper) , Start ;
    }
}

pub(super) fn consult(s: &Situation) -> Choice {
    let Decision { row, action, next } = get_endeff(s.gripper);
    Choice { table: &GET_ENDEFF, row, action, step: next.code() }
}
