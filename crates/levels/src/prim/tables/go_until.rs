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
    /// GO-UNTIL (V.1.1): a guarded move. Done when the condition holds and the robot is at rest. At the goal
    /// without the condition it reports `not-detected` until the condition or another command arrives. After a
    /// restart of the link the condition is tested first; a robot that was stopping is done where it rests.
    pub GO_UNTIL: fn go_until(enum GoUntilStep, super::Situation) -> super::Action {
        Start | Going | Missed {
            1:  guard: Faulty                                       => Fail(SensorError);
            2:  guard: Met                                          => Detect  -> Stopping;
        }
        /// No motion commanded yet.
        Start {
            3:  guard: Clear                                        => Go      -> Going;
        }
        /// The robot moves to the goal.
        Going {
            4:  guard: Clear, way: Lost                             => Go;
            5:  guard: Clear, way: Kept, goal: UnderWay | Settling  => Wait;
            6:  guard: Clear, way: Kept, goal: Arrived              => Miss    -> Missed;
            7:  guard: Clear, way: Kept, goal: Late                 => Fail(NotAtGoal);
        }
        /// The condition holds; the robot comes to rest.
        Stopping {
            8:  rest: UnderWay | Settling                           => Wait;
            9:  rest: Arrived                                       => Finish;
            10: rest: Late                                          => Fail(NotAtGoal);
        }
        /// The robot is at the goal, and the condition does not hold.
        Missed {
            11: guard: Clear                                        => Wait;
        }
    }
}
