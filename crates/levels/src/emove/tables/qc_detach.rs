//! QC-DETACH (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// QC-DETACH (V.2.1): down until the large sensors of the holster see the ears, unlock, forward until the
    /// small ones see them, up, and check that the gripper stayed there. What is done next depends on where the
    /// robot is in the holster and on what is mated and locked, so that a command that is sent again goes on
    /// (docs/design/recovery.md "Exchange"). Done at once if the gripper is in its holster and the robot clear.
    pub QC_DETACH: fn qc_detach(enum QcDetachStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                                                           => Wait;
            2: lock: Implausible                                                    => FailRing;
        }
        /// The robot is moving up out of the gripper.
        Rising {
            3: mate: Right | Wrong                                                  => Fail(NotDetached);
            4: mate: None, holster: Empty | Partial                                 => Fail(NotDetached);
            5: mate: None, holster: Full, along: Above                              => Stand;
        }
        any {
            6: mate: Wrong                                                          => Fail(WrongGripper);
            7: mate: None, holster: Empty | Partial                                 => Fail(WrongGripper);
            8: mate: None, holster: Full, along: Off | Above | Clear                => Finish;
            9: mate: None, along: Sliding | Low | Lifting | Raising                 => Fail(NotDetached);
        }
        /// The quick change is unlocking; the gripper drops.
        Unlocking {
            10: lock: Locked | Between                                              => FailRing;
        }
        any {
            11: mate: None, along: Out | Coming | Seat, lock: Locked | Between      => Unlock -> Unlocking;
            12: mate: None, along: Out | Coming | Seat, lock: Unlocked              => DeltaMove(QcdOut) -> Rising;
            13: mate: Right, along: Off                                             => Fail(NotPrepared);
            14: mate: Right, along: Above | Out | Coming                            => Fail(NotDetached);
        }
        /// The gripper is moving down into the holster.
        Lowering {
            15: mate: Right, along: Low | Lifting | Sliding, lock: Locked | Between => Unlock -> Unlocking;
        }
        /// The gripper is being pushed to its seat.
        Seating {
            16: mate: Right, lock: Unlocked                                         => DeltaMove(QcdUp) -> Rising;
        }
        any {
            17: mate: Right, along: Lifting | Raising | Clear, held: Right | Other   => Fail(AlreadyHolding);
            18: mate: Right, along: Lifting | Raising | Clear, held: Something       => Fail(AlreadyHolding);
            19: mate: Right, along: Lifting | Raising | Clear, held: NotKnown        => Fail(HeldNotKnown);
            20: mate: Right, along: Raising | Clear, holster: Partial | Full         => Fail(HolsterOccupied);
            21: mate: Right, along: Lifting | Raising | Clear, lock: Unlocked | Between => Fail(RingNotLocked);
            22: mate: Right, along: Lifting | Raising | Clear, lock: Locked          => GoUntil(QcdDown) -> Lowering;
            23: mate: Right, along: Low, holster: Empty, lock: Locked                => GoUntil(QcdDown) -> Lowering;
            24: mate: Right, along: Low | Sliding | Seat, lock: Locked | Between     => Unlock -> Unlocking;
            25: mate: Right, along: Low | Sliding, lock: Unlocked                    => GoUntil(QcdSeat) -> Seating;
            26: mate: Right, along: Seat, holster: Empty | Partial, lock: Unlocked   => GoUntil(QcdSeat) -> Seating;
            27: mate: Right, along: Seat, holster: Full, lock: Unlocked              => DeltaMove(QcdUp) -> Rising;
        }
    }
}
