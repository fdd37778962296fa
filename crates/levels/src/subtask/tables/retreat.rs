//! RETREAT (example).

use rcs_core::decision_table;

decision_table! {
    /// RETREAT: let go of what is held and move to the location.
    pub RETREAT: fn retreat(enum RetreatStep, super::Situation) -> super::Action {
        any {
            1: work: Busy       => Wait;
        }
        /// Nothing done yet.
        Start {
            2: work: Over       => Release      -> Releasing;
        }
        /// The gripper is opening.
        Releasing {
            3: work: Over       => MovToLoc     -> Leaving;
        }
        /// The robot is on its way.
        Leaving {
            4: work: Over       => Finish;
        }
    }
}
