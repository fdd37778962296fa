//! QC-DETACH (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// QC-DETACH (V.2.1): down until the large sensors of the holster see the ears, unlock, forward until the
    /// small ones see them, up, and check that the gripper stayed there. What is done next depends on where the
    /// robot is in the holster and on what is mated and locked, so that a command that is sent again goes on
    /// (docs/design/recovery.md "Exchange"). Done at once if the gripper is in its holster and the robot clear.
    pub QC_DETACH: fn qc_detach(enum QcDetachStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                                                             => Wait;
            2: lock: Faulty                                                      => FailRing;
        }
        /// Nothing done yet.
        Start {
            3: mate: None, holster: Full, at: There | Before | InDrum                 => Finish;
            4: mate: None, holster: Full, along: Off | Above | Clear                  => Finish;
            5: mate: None, holster: Empty | Partial                                   => Fail(WrongGripper);
        }
        /// The robot is moving up out of the gripper.
        Rising {
            6: mate: Right | Wrong                                                    => Fail(NotDetached);
            7: mate: None, holster: Empty | Partial                                   => Fail(NotDetached);
            8: lock: Locked | Between                                                 => FailRing;
            9: mate: None, holster: Full                                              => Stand;
        }
        /// The gripper is moving down into the holster.
        Lowering {
            10: mate: Right, lock: Locked | Between                                   => Unlock -> Unlocking;
        }
        /// The gripper is being pushed to its seat.
        Seating {
            11: mate: Right, lock: Unlocked                                           => DeltaMove(QcdUp) -> Rising;
        }
        any {
            12: mate: Wrong                                                           => Fail(WrongGripper);
            13: mate: None, holster: Empty | Partial                                  => Fail(NotDetached);
            14: mate: None, along: Off | Above | Clear                                => Fail(NotDetached);
            15: mate: None, along: Sliding | Low | Lifting | Raising                  => Fail(NotDetached);
            16: mate: Right, along: Off                                               => Fail(NotPrepared);
            17: mate: Right, along: Above | Out | Coming                              => Fail(NotDetached);
        }
        /// The quick change is unlocking; the gripper drops.
        Unlocking {
            18: lock: Locked | Between                                                => FailRing;
        }
        any {
            19: mate: None, along: Out | Coming | Seat, lock: Locked | Between        => Unlock -> Unlocking;
            20: mate: None, along: Out | Coming | Seat, lock: Unlocked                => DeltaMove(QcdOut) -> Rising;
        }
        any {
            21: along: Lifting | Raising | Clear, held: Right | Other | Something     => Fail(AlreadyHolding);
            22: along: Lifting | Raising | Clear, held: NotKnown                      => Fail(HeldNotKnown);
            23: along: Raising | Clear, holster: Partial | Full                       => Fail(HolsterOccupied);
            24: along: Lifting | Raising | Clear, lock: Unlocked | Between            => Fail(RingNotLocked);
            25: along: Lifting | Raising | Clear, lock: Locked                        => GoUntil(QcdDown) -> Lowering;
            26: along: Low, holster: Empty, lock: Locked                              => GoUntil(QcdDown) -> Lowering;
            27: along: Low | Sliding | Seat, lock: Locked | Between                   => Unlock -> Unlocking;
            28: along: Low | Sliding, lock: Unlocked                                  => GoUntil(QcdSeat) -> Seating;
            29: along: Seat, holster: Empty | Partial, lock: Unlocked                 => GoUntil(QcdSeat) -> Seating;
            30: along: Seat, holster: Full, lock: Unlocked                            => DeltaMove(QcdUp) -> Rising;
        }
    }
}
