use rcs_core::decision_table;

decision_table! {
    /// GET-OBJECT (V.3.1): find the object if vision is needed, move to it and grasp it. If it is held in a grip that
    /// the command names, only GRASP-OBJ is sent: E-move checks the fingers and finishes at once unless a release was
    /// interrupted. An object that vision has found is not located again. Something unknown that is held at the
    /// object's location is the result of an interrupted grasp, which is repeated. An object that may have slid in
    /// the fingers is released and located again if it is where pictures are taken.
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
        /// The gripper opens, so that the object can be located again.
        Releasing {
            11: otherwise                                              => MovToVu     -> Viewing;
        }
        /// The robot moves to the viewing location.
        Viewing {
            12: otherwise                                              => LocateObj   -> Locating;
        }
        /// Vision locates the object.
        Locating {
            13: otherwise                                              => MovToObj    -> Moving;
        }
        /// The robot moves to the object. If the link to the robot fails, the pictures are lost, and E-move would use
        /// the location of the task data.
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
