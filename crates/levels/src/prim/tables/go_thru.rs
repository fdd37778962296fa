//! GO-THRU (V.1.1).

use rcs_core::decision_table;

decision_table! {
    /// GO-THRU (V.1.1): move near a point on the way to the next. Done within the brake distance; the robot
    /// flies on while the next command comes, and stops at the point if none does.
    pub GO_THRU: fn go_thru(enum GoThruStep, super::Situation) -> super::Action {
        /// Nothing done yet.
        Start {
            1: otherwise                     => Go  -> Going;
        }
        /// The robot is on its way.
        Going {
            2: way: Lost                     => Go;
            3: way: Kept, passage: UnderWay  => Wait;
            4: way: Kept, passage: Passing   => Finish;
        }
    }
}
