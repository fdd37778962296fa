//! GO-UNTIL (V.1.1).
//!
//! ```text
//!             condition                          stands
//!   Start ----------------------> Stopping ------------------> done
//!     |                            ^    ^
//!     v         condition          |    |  condition
//!   Going -------------------------'    |
//!     |    at the goal                  |
//!     `-------------------------> Missed: not-detected
//! ```

use rcs_core::decision_table;

decision_table! {
    /// GO-UNTIL (V.1.1): a guarded move. Done when the condition has come and the robot stands; a goal
    /// without it is `not-detected` until it comes after all, or another command does. After a restart of the
    /// link the condition is asked first; a robot that was coming to rest is done where it rests.
    pub GO_UNTIL: fn go_until(enum GoUntilStep, super::Situation) -> super::Action {
        Start | Going | Missed {
            1:  guard: Faulty                                       => Fail(SensorError);
            2:  guard: Met                                          => Detect  -> Stopping;
        }
        /// Nothing done yet.
        Start {
            3:  guard: Clear                                        => Go      -> Going;
        }
        /// The robot is on its way.
        Going {
            4:  guard: Clear, way: Lost                             => Go;
            5:  guard: Clear, way: Kept, goal: UnderWay | Settling  => Wait;
            6:  guard: Clear, way: Kept, goal: Arrived              => Miss    -> Missed;
            7:  guard: Clear, way: Kept, goal: Late                 => Fail(NotAtGoal);
        }
        /// The condition has come; the robot comes to rest.
        Stopping {
            8:  rest: UnderWay | Settling                           => Wait;
            9:  rest: Arrived                                       => Finish;
            10: rest: Late                                          => Fail(NotAtGoal);
        }
        /// The robot is at the goal, and the condition has not come.
        Missed {
            11: guard: Clear                                        => Wait;
        }
    }
}
