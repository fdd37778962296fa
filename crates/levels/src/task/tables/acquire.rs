//! ACQUIRE (V.4.1).

use rcs_core::decision_table;

decision_table! {
    /// ACQUIRE (V.4.1): get the proper end effector, move to the object and grasp it.
    pub ACQUIRE: fn acquire(enum AcquireStep, super::Situation) -> super::Action {
        any {
            1: work: Busy  => Wait;
        }
        /// Nothing done yet.
        Start {
            2: work: Over  => GetEndeff  -> Gripper;
        }
        /// The gripper is being fetched.
        Gripper {
            3: work: Over  => GetObject  -> Object;
        }
        /// The object is being fetched.
        Object {
            4: work: Over  => Finish;
        }
    }
}
