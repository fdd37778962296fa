//! PLACE-OBJ (V.3.1).

use rcs_core::decision_table;

decision_table! {
    /// PLACE-OBJ (V.3.1): move an object to a location and release it. E-move reports an object that is lost on the way.
    pub PLACE_OBJ: fn place_obj(enum PlaceObjStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                               => Wait;
        }
        /// Nothing done yet.
        Start {
            2: held: Right, grip: Destination | Unknown    => MovObjTo         -> Moving;
            3: held: Right, grip: Source | Neither         => Fail(RegripNeeded);
            4: held: Nothing | Other                       => Fail(NothingHeld);
        }
        /// The object is on its way.
        Moving {
            5: held: Right                                 => Release          -> Releasing;
            6: held: Nothing | Other                       => Fail(ObjectLost);
        }
        /// The gripper is opening.
        Releasing {
            7: work: Over                                  => Finish;
        }
    }
}
