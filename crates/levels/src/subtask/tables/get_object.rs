//! GET-OBJECT (V.3.1).

use rcs_core::decision_table;

decision_table! {
    /// GET-OBJECT (V.3.1): find the object if vision is needed, move to it and grasp it. If it counts as held
    /// with a grip that the command names, GRASP-OBJ alone is sent: E-move asks the fingers, and ends it at
    /// once unless a release has not ended well. What vision has found already is not looked for again.
    /// Something unknown that is held where the object is gone to is what an interrupted grasp has closed on:
    /// the grasp is made again. An object that may have slid in the fingers, in a place where pictures are taken,
    /// is released there and looked for again.
    pub GET_OBJECT: fn get_object(enum GetObjectStep, super::Situation) -> super::Action {
        Start | Releasing | Viewing | Locating | Grasping {
            1:  work: Busy                                             => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  held: Other                                            => Fail(AlreadyHolding);
            3:  held: NotKnown                                         => Fail(HeldNotKnown);
            4:  held: Nothing, vision: Needed                          => MovToVu     -> Viewing;
            5:  held: Nothing, vision: NotNeeded | Done                => MovToObj    -> Moving;
            6:  seat: NotKnown, station: There, vision: Needed | Done  => Release     -> Releasing;
            7:  held: Right,     grip: Source | Destination            => GraspAgain  -> Grasping;
            8:  held: Right,     grip: Neither                         => Fail(RegripNeeded);
            9:  held: Something, station: There                        => GraspObj    -> Grasping;
            10: held: Something, station: Elsewhere                    => Fail(UnknownHeld);
        }
        /// The gripper is opening, to let the object be looked for again.
        Releasing {
            11: otherwise                                              => MovToVu     -> Viewing;
        }
        /// The robot is on its way to where the picture is taken.
        Viewing {
            12: otherwise                                              => LocateObj   -> Locating;
        }
        /// Vision is looking for the object.
        Locating {
            13: otherwise                                              => MovToObj    -> Moving;
        }
        /// The robot is on its way to the object. A link to the robot that fails drops the pictures: E-move would
        /// go to where the task data have the object.
        Moving {
            14: vision: Needed                                         => MovToVu     -> Viewing;
            15: work: Busy                                             => Wait;
            16: otherwise                                              => GraspObj    -> Grasping;
        }
        /// The gripper is closing.
        Grasping {
            17: held: Right                                            => Finish;
            18: held: Nothing | Other                                  => Fail(GraspMissed);
            19: held: Something                                        => Fail(UnknownHeld);
            20: held: NotKnown                                         => Fail(HeldNotKnown);
        }
    }
}
