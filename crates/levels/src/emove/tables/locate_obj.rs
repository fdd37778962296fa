//! LOCATE-OBJ (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// LOCATE-OBJ (V.2.1): a fast flood picture, centre the camera over the object, a second picture with recognition
    /// and angle, align. The robot moves straight and must hold no object: an interrupted grasp may have ended since,
    /// and then the robot is in the nest of the part. The camera does not move to an object so near to the edge of
    /// its tray that the open fingers would hit the wall.
    pub LOCATE_OBJ: fn locate_obj(enum LocateObjStep, struct of super::Senses) -> super::Action {
        any {
            1:  work: Busy                                                => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  held: Nothing, ahead: Rejoin                              => GotoPt   -> Correcting;
        }
        /// The robot is returning to the place of the pictures.
        Correcting {
            3:  otherwise                                                 => Flood    -> Flooding;
        }
        Start {
            4:  held: Nothing                                             => Flood    -> Flooding;
        }
        Flooding | Measuring {
            5:  sight: Seen, aim: Unknown                                 => Fail(BadRecord);
            6:  sight: Implausible, tries: Spent                          => Fail(VisionImplausible);
            7:  sight: Missing, tries: Spent                              => Fail(NothingSeen);
        }
        /// The fast flood picture is being taken.
        Flooding {
            8:  sight: Seen, aim: Known                                   => Centre   -> Centring;
            9:  sight: Missing | Unrecognised | Implausible, tries: Left  => FloodAgain;
            10: sight: Unrecognised, tries: Spent                         => Fail(NothingSeen);
        }
        /// The camera is moving over the centroid.
        Centring {
            11: otherwise                                                 => Precise  -> Measuring;
        }
        /// The second picture is being taken.
        Measuring {
            12: sight: Seen, aim: Known, reach: Inside                    => Align    -> Aligning;
            13: sight: Missing | Unrecognised | Implausible, tries: Left  => PreciseAgain;
            14: sight: Unrecognised, tries: Spent                         => Fail(NotRecognised);
        }
        /// The camera is moving over the part, and turning with it.
        Aligning {
            15: otherwise                                                 => Located;
        }
        Start {
            16: held: Right | Other | Something                           => Fail(AlreadyHolding);
            17: held: NotKnown                                            => Fail(HeldNotKnown);
        }
        Measuring {
            18: sight: Seen, aim: Known, reach: Outside                   => Fail(AtTrayEdge);
        }
    }
}
