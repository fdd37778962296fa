use rcs_core::decision_table;

decision_table! {
    /// PLACE-OBJ (V.3.1): move an object to a location and release it. The command finishes at once if this object
    /// was the last release there. E-move reports an object that is lost during the motion.
    pub PLACE_OBJ: fn place_obj(enum PlaceObjStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                             => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  held: Right,   grip: Destination       => MovObjTo  -> Moving;
            3:  held: Right,   grip: Source | Neither  => Fail(RegripNeeded);
            4:  held: Nothing, placed: There           => Finish;
            5:  held: Nothing, placed: Elsewhere       => Fail(NothingHeld);
            6:  held: Other                            => Fail(NothingHeld);
            7:  held: Something                        => Fail(UnknownHeld);
            8:  held: NotKnown                         => Fail(HeldNotKnown);
        }
        /// The robot moves the object.
        Moving {
            9:  held: Right                            => Release   -> Releasing;
            10: held: Nothing | Other                  => Fail(ObjectLost);
            11: held: Something                        => Fail(UnknownHeld);
            12: held: NotKnown                         => Fail(HeldNotKnown);
        }
        /// The gripper is opening.
        Releasing {
            13: otherwise                              => Finish;
        }
    }
}
