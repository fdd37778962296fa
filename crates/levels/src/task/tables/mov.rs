//! MOVE (V.4.1).

use rcs_core::decision_table;

decision_table! {
    /// MOVE (V.4.1): move an object to a location and hold it there, or move the robot; the end-at location
    /// is ignored.
    pub MOVE: fn r#move(enum MoveStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                            => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  handling: NoObject                    => GotoDest       -> Moving;
            3:  handling: Object, update: Owed        => TellOwed       -> Settling;
            4:  handling: Object, update: None | Due  => GetEndeff      -> Gripper;
        }
        /// The data base is told an earlier update again.
        Settling {
            5:  work: Over                            => GetEndeff      -> Gripper;
        }
        /// The gripper is being fetched.
        Gripper {
            6:  work: Over                            => GetObject      -> Object;
        }
        /// The object is being fetched.
        Object {
            7:  grips: Same                           => MoveObjToDest  -> Moving;
            8:  grips: Different                      => FixGrip        -> Regripping;
        }
        /// The object is being regripped on the pedestal.
        Regripping {
            9:  work: Over                            => MoveObjToDest  -> Moving;
        }
        /// The object, or the robot alone, is on its way.
        Moving {
            10: update: Due                           => Update         -> Telling;
            11: update: None | Owed                   => Finish;
        }
        /// The data base is being told where the object is.
        Telling {
            12: work: Over                            => Finish;
        }
    }
}
