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
            1:  work: Busy                              => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  held: Right | Something, seat: NotKnown, station: There, vision: Needed | Done
                                                        => Release          -> Releasing;
            3:  held: Right, grip: Source | Destination => GraspAgain       -> Grasping;
            4:  held: Right, grip: Neither               => Fail(RegripNeeded);
            5:  held: Other                             => Fail(AlreadyHolding);
            6:  held: Something, station: There         => GraspObj         -> Grasping;
            7:  held: Something, station: Elsewhere     => Fail(UnknownHeld);
            8:  held: NotKnown                          => Fail(HeldNotKnown);
            9:  held: Nothing, vision: Needed           => MovToVu          -> Viewing;
            10: held: Nothing, vision: NotNeeded | Done => MovToObj         -> Moving;
        }
        /// The gripper is opening, to let the object be looked for again.
        Releasing {
            11: work: Over                              => MovToVu          -> Viewing;
        }
        /// The robot is on its way to where the picture is taken.
        Viewing {
            12: work: Over                              => LocateObj        -> Locating;
        }
        /// Vision is looking for the object.
        Locating {
            13: work: Over                              => MovToObj         -> Moving;
        }
        /// The robot is on its way to the object. A link to the robot that fails drops the pictures: E-move would
        /// go to where the task data have the object.
        Moving {
            14: vision: Needed                          => MovToVu          -> Viewing;
            15: vision: NotNeeded | Done, work: Busy    => Wait;
            16: vision: NotNeeded | Done, work: Over    => GraspObj         -> Grasping;
        }
        /// The gripper is closing.
        Grasping {
            17: held: Right                             => Finish;
            18: held: Nothing | Other                   => Fail(GraspMissed);
            19: held: Something                         => Fail(UnknownHeld);
            20: held: NotKnown                          => Fail(HeldNotKnown);
        }
    }
}
