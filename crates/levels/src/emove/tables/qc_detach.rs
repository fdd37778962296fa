//! QC-DETACH (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// QC-DETACH (V.2.1): down until the large sensors of the holster see the ears, unlock, forward until the
    /// small ones see them, up, and check that the gripper stayed there. Done at once if it is there.
    pub QC_DETACH: fn qc_detach(enum QcDetachStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                                               => Wait;
        }
        /// Nothing done yet.
        Start {
            2: mate: Wrong                                              => Fail(WrongGripper);
            3: mate: None, holster: Full                                => Finish;
            4: mate: None, holster: Empty | Partial                     => Fail(WrongGripper);
            5: mate: Right, at: Elsewhere | InDrum                      => Fail(NotPrepared);
            6: mate: Right, at: There, held: Right | Other              => Fail(AlreadyHolding);
            7: mate: Right, at: There, holster: Partial | Full          => Fail(HolsterOccupied);
            8: mate: Right, at: There, holster: Empty                   => GoUntil(QcdDown) -> Lowering;
        }
        /// The gripper is moving down into the holster.
        Lowering {
            9: work: Over                                               => Unlock           -> Unlocking;
        }
        /// The quick change is unlocking; the gripper drops.
        Unlocking {
            10: ring: Unlocked                                          => GoUntil(QcdSeat) -> Seating;
            11: ring: Busy | Locked | Faulty                            => FailRing;
        }
        /// The gripper is being pushed to its seat.
        Seating {
            12: work: Over                                              => DeltaMove(QcdUp) -> Rising;
        }
        /// The robot is moving up out of the gripper.
        Rising {
            13: mate: Right | Wrong                                     => Fail(NotDetached);
            14: mate: None, holster: Empty | Partial                    => Fail(NotDetached);
            15: mate: None, holster: Full, ring: Unlocked               => Stand;
            16: mate: None, holster: Full, ring: Busy | Locked | Faulty => FailRing;
        }
    }
}
