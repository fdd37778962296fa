//! REFIXTURE (V.4.1).

use rcs_core::decision_table;

decision_table! {
    /// REFIXTURE (V.4.1): take an object, reorient it with the Active Pedestal, and hold it at the
    /// destination. For an object that is held already, as after ACQUIRE, the gripper is not fetched. Sent
    /// again after an interruption it goes on with the part in the pedestal's hand.
    pub REFIXTURE: fn refixture(enum RefixtureStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                                   => Wait;
        }
        /// Nothing done yet.
        Start {
            2: part: InPedestal                             => FixGrip        -> Regripping;
            3: held: Right                                  => GetObject      -> Object;
            4: held: Nothing | Other                        => GetEndeff      -> Gripper;
            5: held: Something | NotKnown                   => GetEndeff      -> Gripper;
        }
        /// The gripper is being fetched.
        Gripper {
            6: work: Over                                   => GetObject      -> Object;
        }
        /// The object is being fetched.
        Object {
            7: work: Over                                   => FixGrip        -> Regripping;
        }
        /// The object is being regripped on the pedestal.
        Regripping {
            8: work: Over                                   => MoveObjToDest  -> Moving;
        }
        /// The object is on its way to the destination.
        Moving {
            9: work: Over                                   => Finish;
        }
    }
}
