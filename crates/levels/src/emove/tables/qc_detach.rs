//! QC-DETACH (V.2.1): the motion of the gripper into its holster, and out of the holster without it.

use rcs_core::{Plain, decision_table};

/// Steps of QC-DETACH, by the last order.
///
/// ```text
///   QC-DETACH (mated):  Start -> Lowering -> Unlocking -> Seating -> Rising
///   QC-LEAVE (bare):    Start -> (Unlocking) -> Rising                       no gripper: Start -> Leaving
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum QcDetachStep {
    /// Nothing done yet.
    Start,
    /// A bare robot that has found no gripper is moving up out of the holster.
    Leaving,
    /// The robot is moving up out of the gripper.
    Rising,
    /// The gripper is moving down into the holster.
    Lowering,
    /// The gripper is being pushed to its seat.
    Seating,
    /// The quick change is unlocking; the gripper drops.
    Unlocking,
}

decision_table! {
    /// QC-LEAVE: last part of QC-DETACH (V.2.1), with no gripper mated: up, and check that the gripper stayed in its
    /// holster. A bare robot in an empty holster leaves upward. Done at once if the gripper is in its holster and the
    /// robot clear.
    pub QC_LEAVE: fn qc_leave(self::QcDetachStep, struct of super::Senses) -> super::Action or () {
        any {
            1:  mate: Right | Wrong                                 => consult;
        }
        Start {
            2:  holster: Full, at: There | Before | InDrum          => Finish;
            3:  holster: Full, along: Off                           => Finish;
        }
        Start | Leaving {
            4:  along: Above | Clear                                => Stand;
        }
        Start {
            5:  holster: Empty, along: Out | Coming | Seat          => DeltaMove(QcdOut)  -> Leaving;
            6:  holster: Partial, along: Out | Coming | Seat, lock: Unlocked => DeltaMove(QcdOut) -> Leaving;
            7:  holster: Empty | Partial                            => Fail(WrongGripper);
        }
        Leaving {
            8:  along: Out | Coming | Seat                          => Fail(NoEffect);
        }
        any {
            9:  holster: Empty | Partial                            => Fail(NotDetached);
        }
        Rising {
            10: lock: Locked | Between                              => FailRing;
            11: lock: Unlocked | Faulty                             => Stand;
        }
        Unlocking {
            12: along: Out | Coming | Seat, lock: Locked | Between  => FailRing;
        }
        any {
            13: along: Out | Coming | Seat, lock: Locked | Between  => Unlock             -> Unlocking;
            14: along: Out | Coming | Seat                          => DeltaMove(QcdOut)  -> Rising;
            15: otherwise                                           => Fail(NotDetached);
        }
    }
}

decision_table! {
    /// QC-DETACH (V.2.1): down until the large sensors of the holster see the ears, unlock, forward until the small
    /// ones see them, up, and check that the gripper stayed there. The next action depends on the robot's position in
    /// the holster and on gripper and ring, so that a repeated command continues (docs/design/recovery.md
    /// "Exchange"). This table leaves the gripper in the holster; QC-LEAVE, which is consulted before, continues once
    /// the robot is bare.
    pub QC_DETACH: fn qc_detach(self::QcDetachStep, struct of super::Senses) -> super::Action {
        Rising {
            1:  otherwise                                                 => Fail(NotDetached);
        }
        any {
            2:  mate: Wrong                                               => Fail(WrongGripper);
        }
        Lowering {
            3:  lock: Locked | Between                                    => Unlock            -> Unlocking;
        }
        Seating {
            4:  lock: Unlocked                                            => DeltaMove(QcdUp)  -> Rising;
        }
        any {
            5:  along: Off                                                => Fail(NotPrepared);
            6:  along: Above | Out                                        => Fail(NotDetached);
            7:  along: Coming, lock: Locked | Between                     => Fail(NotDetached);
        }
        Unlocking {
            8:  lock: Locked | Between                                    => FailRing;
            9:  lock: Unlocked                                            => GoUntil(QcdSeat)  -> Seating;
        }
        any {
            10: along: Raising | Clear, lock: Unlocked | Between          => Fail(RingNotLocked);
            11: along: Lifting, holster: Empty, lock: Unlocked | Between  => Fail(RingNotLocked);
            12: along: Lifting | Raising | Clear, lock: Locked, held: Right | Other | Something
                                                                          => Fail(AlreadyHolding);
            13: along: Lifting | Raising | Clear, lock: Locked, held: NotKnown => Fail(HeldNotKnown);
            14: along: Raising | Clear, holster: Partial | Full           => Fail(HolsterOccupied);
            15: along: Lifting | Raising | Clear, lock: Locked            => GoUntil(QcdDown)  -> Lowering;
            16: along: Low, holster: Empty, lock: Locked                  => GoUntil(QcdDown)  -> Lowering;
            17: along: Coming | Seat, holster: Full, lock: Unlocked       => DeltaMove(QcdUp)  -> Rising;
            18: lock: Unlocked                                            => GoUntil(QcdSeat)  -> Seating;
            19: otherwise                                                 => Unlock            -> Unlocking;
        }
    }
}
