//! QC-DETACH (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// QC-DETACH (V.2.1): down until the large sensors of the holster see the ears, unlock, forward until the
    /// small ones see them, up, and check that the gripper stayed there. What is done next depends on where
    /// the robot is in the holster and on what is mated and locked, so that a command that is sent again goes
    /// on (docs/design/recovery.md "Exchange"); a bare robot in an empty holster leaves upward. Done at once
    /// if the gripper is in its holster and the robot clear.
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
            6:  mate: None, holster: Empty | Partial, along: Above | Clear   => Stand;
            7:  mate: None, holster: Empty, along: Out | Coming | Seat       => DeltaMove(QcdOut) -> Leaving;
            8:  mate: None, holster: Partial, along: Out | Coming | Seat, lock: Unlocked
                                                                             => DeltaMove(QcdOut) -> Leaving;
            9:  mate: None, holster: Empty | Partial                         => Fail(WrongGripper);
        }
        /// A bare robot that has found no gripper moves up out of the holster.
        Leaving {
            10: mate: None, along: Above                                     => Stand;
            11: mate: None, along: Out | Coming | Seat                       => Fail(NoEffect);
        }
        /// The robot is moving up out of the gripper.
        Rising {
            12: mate: Right | Wrong                                          => Fail(NotDetached);
            13: mate: None, holster: Empty | Partial                         => Fail(NotDetached);
            14: lock: Locked | Between                                       => FailRing;
            15: mate: None, holster: Full                                    => Stand;
        }
        /// The gripper is moving down into the holster.
        Lowering {
            16: mate: Right, lock: Locked | Between                          => Unlock -> Unlocking;
        }
        /// The gripper is being pushed to its seat.
        Seating {
            17: mate: Right, lock: Unlocked                                  => DeltaMove(QcdUp) -> Rising;
        }
        any {
            18: mate: Wrong                                                  => Fail(WrongGripper);
            19: mate: None, holster: Empty | Partial                         => Fail(NotDetached);
            20: mate: None, along: Off | Above | Clear                       => Fail(NotDetached);
            21: mate: None, along: Sliding | Low | Lifting | Raising         => Fail(NotDetached);
            22: mate: Right, along: Off                                      => Fail(NotPrepared);
            23: mate: Right, along: Above | Out                              => Fail(NotDetached);
            24: mate: Right, along: Coming, lock: Locked | Between           => Fail(NotDetached);
        }
        /// The quick change is unlocking; the gripper drops.
        Unlocking {
            25: lock: Locked | Between                                       => FailRing;
            26: mate: Right, lock: Unlocked                                  => GoUntil(QcdSeat) -> Seating;
        }
        any {
            27: mate: None, along: Out | Coming | Seat, lock: Locked | Between => Unlock -> Unlocking;
            28: mate: None, along: Out | Coming | Seat, lock: Unlocked       => DeltaMove(QcdOut) -> Rising;
        }
        any {
            29: along: Raising | Clear, lock: Unlocked | Between             => Fail(RingNotLocked);
            30: along: Lifting, holster: Empty, lock: Unlocked | Between     => Fail(RingNotLocked);
            31: along: Lifting | Raising | Clear, lock: Locked, held: Right | Other => Fail(AlreadyHolding);
            32: along: Lifting | Raising | Clear, lock: Locked, held: Something => Fail(AlreadyHolding);
            33: along: Lifting | Raising | Clear, lock: Locked, held: NotKnown => Fail(HeldNotKnown);
            34: along: Raising | Clear, holster: Partial | Full              => Fail(HolsterOccupied);
            35: along: Lifting | Raising | Clear, lock: Locked               => GoUntil(QcdDown) -> Lowering;
            36: along: Low, holster: Empty, lock: Locked                     => GoUntil(QcdDown) -> Lowering;
            37: along: Lifting | Low | Sliding | Seat, lock: Locked | Between => Unlock -> Unlocking;
            38: along: Lifting | Low | Sliding, lock: Unlocked               => GoUntil(QcdSeat) -> Seating;
            39: along: Coming | Seat, holster: Empty | Partial, lock: Unlocked => GoUntil(QcdSeat) -> Seating;
            40: along: Coming | Seat, holster: Full, lock: Unlocked          => DeltaMove(QcdUp) -> Rising;
        }
    }
}
