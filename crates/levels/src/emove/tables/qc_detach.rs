//! QC-DETACH (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// QC-DETACH (V.2.1): down until the large sensors of the holster see the ears, unlock, forward until the
    /// small ones see them, up, and check that the gripper stayed there. What is done next depends on where the
    /// robot is in the holster and on what is mated and locked, so that a command that is sent again goes on
    /// (docs/design/recovery.md "Exchange"). Done at once if the gripper is in its holster and the robot clear.
    pub QC_DETACH: fn qc_detach(enum QcDetachStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                                                   => Wait;
            2:  lock: Faulty                                                 => FailRing;
        }
        /// Nothing done yet.
        Start {
            3:  mate: None, holster: Full, at: There | Before | InDrum       => Finish;
            4:  mate: None, holster: Full, along: Above | Clear              => Stand;
            5:  mate: None, holster: Full, along: Off                        => Finish;
            6:  mate: None, holster: Empty | Partial                         => Fail(WrongGripper);
        }
        /// The robot is moving up out of the gripper.
        Rising {
            7:  mate: Right | Wrong                                          => Fail(NotDetached);
            8:  mate: None, holster: Empty | Partial                         => Fail(NotDetached);
            9:  lock: Locked | Between                                       => FailRing;
            10: mate: None, holster: Full                                    => Stand;
        }
        /// The gripper is moving down into the holster.
        Lowering {
            11: mate: Right, lock: Locked | Between                          => Unlock -> Unlocking;
        }
        /// The gripper is being pushed to its seat.
        Seating {
            12: mate: Right, lock: Unlocked                                  => DeltaMove(QcdUp) -> Rising;
        }
        any {
            13: mate: Wrong                                                  => Fail(WrongGripper);
            14: mate: None, holster: Empty | Partial                         => Fail(NotDetached);
            15: mate: None, along: Off | Above | Clear                       => Fail(NotDetached);
            16: mate: None, along: Sliding | Low | Lifting | Raising         => Fail(NotDetached);
            17: mate: Right, along: Off                                      => Fail(NotPrepared);
            18: mate: Right, along: Above | Out | Coming                     => Fail(NotDetached);
        }
        /// The quick change is unlocking; the gripper drops.
        Unlocking {
            19: lock: Locked | Between                                       => FailRing;
            20: mate: Right, lock: Unlocked                                  => GoUntil(QcdSeat) -> Seating;
        }
        any {
            21: mate: None, along: Out | Coming | Seat, lock: Locked | Between => Unlock -> Unlocking;
            22: mate: None, along: Out | Coming | Seat, lock: Unlocked       => DeltaMove(QcdOut) -> Rising;
        }
        any {
            23: along: Raising | Clear, lock: Unlocked | Between             => Fail(RingNotLocked);
            24: along: Lifting, holster: Empty, lock: Unlocked | Between     => Fail(RingNotLocked);
            25: along: Lifting | Raising | Clear, lock: Locked, held: Right | Other => Fail(AlreadyHolding);
            26: along: Lifting | Raising | Clear, lock: Locked, held: Something => Fail(AlreadyHolding);
            27: along: Lifting | Raising | Clear, lock: Locked, held: NotKnown => Fail(HeldNotKnown);
            28: along: Raising | Clear, holster: Partial | Full              => Fail(HolsterOccupied);
            29: along: Lifting | Raising | Clear, lock: Locked               => GoUntil(QcdDown) -> Lowering;
            30: along: Low, holster: Empty, lock: Locked                     => GoUntil(QcdDown) -> Lowering;
            31: along: Lifting | Low | Sliding | Seat, lock: Locked | Between => Unlock -> Unlocking;
            32: along: Lifting | Low | Sliding, lock: Unlocked               => GoUntil(QcdSeat) -> Seating;
            33: along: Seat, holster: Empty | Partial, lock: Unlocked        => GoUntil(QcdSeat) -> Seating;
            34: along: Seat, holster: Full, lock: Unlocked                   => DeltaMove(QcdUp) -> Rising;
        }
    }
}
