use rcs_core::decision_table;

decision_table! {
    /// TRANSFER (V.4.1): move an object from one location to another, then go to the end-at location. The update is
    /// sent when the object is there, so that the database is right even if the robot cannot leave. Repeated after an
    /// interruption, the command continues with the part in the pedestal's hand or with the placed object. Without an
    /// end-at location, a robot that has been moved away returns to the object.
    pub TRANSFER: fn transfer(enum TransferStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                                       => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  update: Pending                                  => SendPending         -> Settling;
        }
        /// An earlier update is sent again.
        Settling {
            3:  update: Pending                                  => SendPending;
        }
        Start | Settling {
            4:  placed: AtDestination                            => Wait                -> Placing;
            5:  placed: Left, ends: There | Elsewhere            => Wait                -> Placing;
            6:  placed: Left, ends: Here                         => Return              -> Placing;
            7:  part: InPedestal, grips: Different               => FixGrip             -> Regripping;
            8:  otherwise                                        => GetEndeff           -> Gripper;
        }
        /// The gripper is being fetched.
        Gripper {
            9:  otherwise                                        => GetObject           -> Object;
        }
        /// The object is being fetched.
        Object {
            10: grips: Same                                      => PlaceObj            -> Placing;
            11: grips: Different                                 => FixGrip             -> Regripping;
        }
        /// The object is being regripped on the pedestal.
        Regripping {
            12: otherwise                                        => PlaceObj            -> Placing;
        }
        /// The object is being placed.
        Placing {
            13: ends: Here,              update: Due             => Update              -> Updating;
            14: ends: Here,              update: None | Pending  => Finish;
            15: ends: There | Elsewhere, update: Due             => UpdateAndGotoEndpt  -> Leaving;
            16: ends: There | Elsewhere, update: None | Pending  => GotoEndpt           -> Leaving;
        }
        /// The robot moves to the end-at location.
        Leaving {
            17: update: Pending                                  => AwaitUpdate         -> Updating;
            18: update: None | Due                               => Finish;
        }
        /// The update with the place of the object is sent.
        Updating {
            19: otherwise                                        => Finish;
        }
    }
}
