//! GOTO-PT and DELTA-MOVE (V.1.1).

use rcs_core::decision_table;

decision_table! {
    /// GOTO-PT, DELTA-MOVE (V.1.1): move to a point, or to a place given relative to a pose by a movetable,
    /// and stop. Done when the robot rests there, not when it was told to.
    pub GOTO_PT: fn goto_pt(enum GotoPtStep, super::Situation) -> super::Action {
        /// Nothing done yet.
        Start {
            1: otherwise                             => Go  -> Going;
        }
        /// The robot is on its way.
        Going {
            2: way: Lost                             => Go;
            3: way: Kept, goal: UnderWay | Settling  => Wait;
            4: way: Kept, goal: Arrived              => Finish;
            5: way: Kept, goal: Late                 => Fail(NotAtGoal);
        }
    }
}
