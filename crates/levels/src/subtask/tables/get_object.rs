//! GET-OBJECT (V.3.1).

use rcs_core::decision_table;

decision_table! {
    /// GET-OBJECT (V.3.1): find the object if vision is needed, move to it and grasp it; done at once if it
    /// is held. What vision has found already is not looked for again. Something unknown that is held where
    /// the object is gone to is what an interrupted grasp has closed on: the grasp is made again.
    pub GET_OBJECT: fn get_object(enum GetObjectStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                              => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  held: Right                             => Finish;
            3:  held: Other                             => Fail(AlreadyHolding);
            4:  held: Something, station: There         => GraspObj         -> Grasping;
            5:  held: Something, station: Elsewhere     => Fail(UnknownHeld);
            6:  held: NotKnown                          => Fail(HeldNotKnown);
            7:  held: Nothing, vision: Needed           => MovToVu          -> Viewing;
            8:  held: Nothing, vision: NotNeeded | Done => MovToObj         -> Moving;
        }
        /// The robot is on its way to where the picture is taken.
        Viewing {
            9:  work: Over                              => LocateObj        -> Locating;
        }
        /// Vision is looking for the object.
        Locating {
            10: work: Over                              => MovToObj         -> Moving;
        }
        /// The robot is on its way to the object.
        Moving {
            11: work: Over                              => GraspObj         -> Grasping;
        }
        /// The gripper is closing.
        Grasping {
            12: held: Right                             => Finish;
            13: held: Nothing | Other                   => Fail(GraspMissed);
            14: held: Something                         => Fail(UnknownHeld);
            15: held: NotKnown                          => Fail(HeldNotKnown);
        }
    }
}
