use rcs_core::decision_table;

decision_table! {
    /// MOVE (V.4.1): move an object to a location and hold it there, or move the robot. The end-at location is
    /// ignored. Repeated after an interruption, the command continues with the part in the pedestal's hand.
    pub MOVE: fn r#move(enum MoveStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                          => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  handling: NoObject                  => GotoDest       -> Moving;
            3:  handling: Object, update: Pending   => SendPending    -> Settling;
        }
        /// An earlier update is sent again.
        Settling {
            4:  update: Pending                     => SendPending;
        }
        Start | Settling {
            5:  part: InPedestal, grips: Different  => FixGrip        -> Regripping;
            6:  otherwise                           => GetEndeff      -> Gripper;
        }
        /// The gripper is being fetched.
        Gripper {
            7:  otherwise                           => GetObject      -> Object;
        }
        /// The object is being fetched.
        Object {
            8:  grips: Same                         => MoveObjToDest  -> Moving;
            9:  grips: Different                    => FixGrip        -> Regripping;
        }
        /// The object is being regripped on the pedestal.
        Regripping {
            10: otherwise                           => MoveObjToDest  -> Moving;
        }
        /// The object, or the robot alone, moves.
        Moving {
            11: update: Due                         => Update         -> Updating;
            12: update: None | Pending              => Finish;
        }
        /// The update with the place of the object is sent.
        Updating {
            13: otherwise                           => Finish;
        }
    }
}
