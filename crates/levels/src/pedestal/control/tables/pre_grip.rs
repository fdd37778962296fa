//! PRE-GRIP (VI.7.1).

use rcs_core::decision_table;

decision_table! {
    /// PRE-GRIP (VI.7.1): open the hand to `grasp-size` and turn the table to the absolute `table-angle`,
    /// both at once.
    pub PRE_GRIP: fn pre_grip(enum PreGripStep, super::Situation) -> super::Action {
        /// Nothing sent yet.
        Start {
            1:                          => OpenAndTurn      -> Moving;
        }
        /// The hand opens, the table turns.
        Moving {
            2:                          => Finish;
        }
    }
}
