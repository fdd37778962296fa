use rcs_core::decision_table;

decision_table! {
    /// GO-THRU (V.1.1): move near a point on the way to the next. Done within the brake distance; the robot
    /// continues when the next command arrives, and stops at the point without one.
    pub GO_THRU: fn go_thru(enum GoThruStep, super::Situation) -> super::Action {
        /// No motion commanded yet.
        Start {
            1: otherwise                     => Go  -> Going;
        }
        /// The robot moves to the point.
        Going {
            2: way: Lost                     => Go;
            3: way: Kept, passage: UnderWay  => Wait;
            4: way: Kept, passage: Passing   => Finish;
        }
    }
}
