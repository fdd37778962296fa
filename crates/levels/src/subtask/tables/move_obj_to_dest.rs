use rcs_core::decision_table;

decision_table! {
    /// MOVE-OBJ>D (V.3.1): move an object to the destination and hold it there.
    pub MOVE_OBJ_TO_DEST: fn move_obj_to_dest(enum MoveObjToDestStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                           => Wait;
        }
        /// Nothing done yet.
        Start {
            2: held: Right, grip: Destination       => MovObjTo  -> Moving;
            3: held: Right, grip: Source | Neither  => Fail(RegripNeeded);
            4: held: Nothing | Other                => Fail(NothingHeld);
        }
        /// The robot moves the object.
        Moving {
            5: held: Right                          => Finish;
            6: held: Nothing | Other                => Fail(ObjectLost);
        }
        any {
            7: held: Something                      => Fail(UnknownHeld);
            8: held: NotKnown                       => Fail(HeldNotKnown);
        }
    }
}
