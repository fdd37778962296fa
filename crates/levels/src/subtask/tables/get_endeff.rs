use rcs_core::decision_table;

decision_table! {
    /// GET-ENDEFF (V.3.1): attach the proper gripper. The command finishes at once if it is attached, locked and
    /// clear of its holster. An interrupted exchange is finished first. A gripper that may hold something stays on
    /// the robot.
    pub GET_ENDEFF: fn get_endeff(enum GetEndeffStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                                           => Wait;
        }
        /// Nothing done yet.
        Start {
            2:  exchange: Wanted                                     => QcAttach          -> Attaching;
            3:  exchange: Other                                      => QcDetach          -> Detaching;
            4:  exchange: None, gripper: Right                       => Finish;
            5:  exchange: None, gripper: Wrong, held: Right | Other  => Fail(AlreadyHolding);
            6:  exchange: None, gripper: Wrong, held: Something      => Fail(UnknownHeld);
            7:  exchange: None, gripper: Wrong, held: NotKnown       => Fail(HeldNotKnown);
            8:  exchange: None, gripper: Wrong, held: Nothing        => MovToHol(Own)     -> Stowing;
            9:  exchange: None, gripper: None                        => MovToHol(Wanted)  -> Fetching;
        }
        /// The robot moves to the holster of its gripper.
        Stowing {
            10: otherwise                                            => QcDetach          -> Detaching;
        }
        /// The gripper is being left in its holster.
        Detaching {
            11: gripper: None, exchange: None                        => MovToHol(Wanted)  -> Fetching;
            12: gripper: None, exchange: Wanted | Other              => Fail(NotDetached);
            13: gripper: Right | Wrong                               => Fail(NotDetached);
        }
        /// The bare robot moves to the holster of the wanted gripper.
        Fetching {
            14: otherwise                                            => QcAttach          -> Attaching;
        }
        /// The wanted gripper is being taken.
        Attaching {
            15: gripper: Right, exchange: None                       => Finish;
            16: gripper: Right, exchange: Wanted | Other             => Fail(NotAttached);
            17: gripper: Wrong                                       => Fail(WrongGripperId);
            18: gripper: None                                        => Fail(NotAttached);
        }
    }
}
