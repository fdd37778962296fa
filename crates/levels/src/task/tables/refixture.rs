//! REFIXTURE (V.4.1).

use rcs_core::decision_table;

decision_table! {
    /// REFIXTURE (V.4.1): take an object, reorient it with the Active Pedestal, and hold it at the
    /// destination. For an object that is held already, as after ACQUIRE, the gripper is not fetched.
    pub REFIXTURE: fn refixture(enum RefixtureStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                => Wait;
        }
        /// Nothing done yet.
        Start {
            2: holding: NotHeld | Other  => GetEndeff      -> Gripper;
            3: holding: Held             => GetObject      -> Object;
        }
        /// The gripper is being fetched.
        Gripper {
            4: work: Over                => GetObject      -> Object;
        }
        /// The object is being fetched.
        Object {
            5: grips: Different          => FixGrip        -> Regripping;
            6: grips: Same               => MoveObjToDest  -> Moving;
        }
        /// The object is being regripped on the pedestal.
        Regripping {
            7: work: Over                => MoveObjToDest  -> Moving;
        }
        /// The object is on its way to the destination.
        Moving {
            8: work: Over                => Finish;
        }
    }
}
