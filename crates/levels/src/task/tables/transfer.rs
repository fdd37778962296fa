//! TRANSFER (V.4.1).

use rcs_core::decision_table;

decision_table! {
    /// TRANSFER (V.4.1): move an object from one location to another, then go to the end-at location. The
    /// data base is told as soon as the object is there, so that it is right also if the robot cannot leave.
    pub TRANSFER: fn transfer(enum TransferStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                                    => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  update: Owed                                  => TellOwed            -> Settling;
            3:  update: None | Due                            => GetEndeff           -> Gripper;
        }
        /// The data base is told an earlier update again.
        Settling {
            4:  work: Over                                    => GetEndeff           -> Gripper;
        }
        /// The gripper is being fetched.
        Gripper {
            5:  work: Over                                    => GetObject           -> Object;
        }
        /// The object is being fetched.
        Object {
            6:  grips: Same                                   => PlaceObj            -> Placing;
            7:  grips: Different                              => FixGrip             -> Regripping;
        }
        /// The object is being regripped on the pedestal.
        Regripping {
            8:  work: Over                                    => PlaceObj            -> Placing;
        }
        /// The object is being placed.
        Placing {
            9:  ends: Here, update: Due                       => Update              -> Telling;
            10: ends: Here, update: None | Owed               => Finish;
            11: ends: There | Elsewhere, update: Due          => UpdateAndGotoEndpt  -> Leaving;
            12: ends: There | Elsewhere, update: None | Owed  => GotoEndpt           -> Leaving;
        }
        /// The robot is on its way to the end-at location.
        Leaving {
            13: update: Owed                                  => AwaitUpdate         -> Telling;
            14: update: None | Due                            => Finish;
        }
        /// The data base is being told where the object is.
        Telling {
            15: work: Over                                    => Finish;
        }
    }
}
