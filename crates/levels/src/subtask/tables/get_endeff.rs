//! GET-ENDEFF (V.3.1).

use rcs_core::decision_table;

decision_table! {
    /// GET-ENDEFF (V.3.1): connect the proper gripper; done at once if it is on. A gripper that holds something is not left.
    pub GET_ENDEFF: fn get_endeff(enum GetEndeffStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                           => Wait;
        }
        /// Nothing done yet.
        Start {
            2: gripper: Right                       => Finish;
            3: gripper: Wrong, held: Right | Other  => Fail(AlreadyHolding);
            4: gripper: Wrong, held: Nothing        => MovToHol(Own)    -> Stowing;
            5: gripper: None                        => MovToHol(Wanted) -> Fetching;
        }
        /// The robot is on its way to the holster of the gripper that it has.
        Stowing {
            6: work: Over                           => QcDetach         -> Detaching;
        }
        /// The gripper is being left in its holster.
        Detaching {
            7: gripper: None                        => MovToHol(Wanted) -> Fetching;
            8: gripper: Right | Wrong               => Fail(NotDetached);
        }
        /// The bare robot is on its way to the holster of the wanted gripper.
        Fetching {
            9: work: Over                           => QcAttach         -> Attaching;
        }
        /// The wanted gripper is being taken.
        Attaching {
            10: gripper: Right                      => Finish;
            11: gripper: Wrong                      => Fail(WrongGripperId);
            12: gripper: None                       => Fail(NotAttached);
        }
    }
}
