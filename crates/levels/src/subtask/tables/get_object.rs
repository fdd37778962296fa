//! GET-OBJECT (V.3.1).

use rcs_core::decision_table;

decision_table! {
    /// GET-OBJECT (V.3.1): find the object if vision is needed, move to it and grasp it; done at once if it is held.
    pub GET_OBJECT: fn get_object(enum GetObjectStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                           => Wait;
        }
        /// Nothing done yet.
        Start {
            2: held: Right                          => Finish;
            3: held: Other                          => Fail(AlreadyHolding);
            4: held: Nothing, vision: Needed        => MovToVu          -> Viewing;
            5: held: Nothing, vision: NotNeeded     => MovToObj         -> Moving;
        }
        /// The robot is on its way to where the picture is taken.
        Viewing {
            6: work: Over                           => LocateObj        -> Locating;
        }
        /// Vision is looking for the object.
        Locating {
            7: work: Over                           => MovToObj         -> Moving;
        }
        /// The robot is on its way to the object.
        Moving {
            8: work: Over                           => GraspObj         -> Grasping;
        }
        /// The gripper is closing.
        Grasping {
            9: held: Right                          => Finish;
            10: held: Nothing | Other               => Fail(GraspMissed);
        }
    }
}
