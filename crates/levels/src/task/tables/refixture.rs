use rcs_core::decision_table;

decision_table! {
    /// REFIXTURE (V.4.1): take an object, reorient it with the Active Pedestal, and hold it at the destination. If
    /// the object is held already, as after ACQUIRE, the gripper is not fetched. Repeated after an interruption, the
    /// command continues with the part in the pedestal's hand. As in all commands that take an object, pending
    /// updates are sent first.
    pub REFIXTURE: fn refixture(enum RefixtureStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                  => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  update: Pending             => SendPending    -> Settling;
        }
        /// An earlier update is sent again.
        Settling {
            3:  update: Pending             => SendPending;
        }
        Start | Settling {
            4:  part: InPedestal            => FixGrip        -> Regripping;
            5:  held: Right                 => GetObject      -> Object;
            6:  held: Nothing | Other       => GetEndeff      -> Gripper;
            7:  held: Something | NotKnown  => GetEndeff      -> Gripper;
        }
        /// The gripper is being fetched.
        Gripper {
            8:  otherwise                   => GetObject      -> Object;
        }
        /// The object is being fetched.
        Object {
            9:  otherwise                   => FixGrip        -> Regripping;
        }
        /// The object is being regripped on the pedestal.
        Regripping {
            10: otherwise                   => MoveObjToDest  -> Moving;
        }
        /// The object moves to the destination.
        Moving {
            11: otherwise                   => Finish;
        }
    }
}
