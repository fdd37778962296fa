use rcs_core::decision_table;

decision_table! {
    /// GOTO-PT, DELTA-MOVE (V.1.1): move to a point, or to a place relative to a pose by a movetable, and stop.
    /// Done when the robot rests at the goal.
    pub GOTO_PT: fn goto_pt(enum GotoPtStep, super::Situation) -> super::Action {
        /// No motion commanded yet.
        Start {
            1: otherwise                             => Go  -> Going;
        }
        /// The robot moves to the goal.
        Going {
            2: way: Lost                             => Go;
            3: way: Kept, goal: UnderWay | Settling  => Wait;
            4: way: Kept, goal: Arrived              => Finish;
            5: way: Kept, goal: Late                 => Fail(NotAtGoal);
        }
    }
}
