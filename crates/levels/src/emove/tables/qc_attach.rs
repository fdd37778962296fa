//! QC-ATTACH (V.2.1): the motion of the bare robot to the gripper, and out of the holster with it.

use rcs_core::{Plain, decision_table};

/// Steps of QC-ATTACH, by the last order.
///
/// ```text
///   QC-ATTACH (bare):  Start -> (Unlocking) -> Approaching -> Mating        no gripper: Undoing -> Leaving
///                                                               |
///   QC-LIFT (mated):                                         Locking -> (Closing) -> Backing -> Lifting
///                                                                       (Calibrating) <- Raising <-'
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum QcAttachStep {
    /// Nothing done yet.
    Start,
    /// The quick change of the bare robot is unlocking.
    Unlocking,
    /// The robot is moving close to the gripper.
    Approaching,
    /// The seat was empty: the robot is moving away from it.
    Undoing,
    /// The bare robot is moving up out of the holster.
    Leaving,
    /// The robot is moving slowly onto the gripper.
    Mating,
    /// The quick change is locking.
    Locking,
    /// The gripper is closing.
    Closing,
    /// The gripper is sliding back out of its seat.
    Backing,
    /// The gripper is being lifted a distance out of the holster.
    Lifting,
    /// The gripper is being lifted completely out of the holster.
    Raising,
    /// The gripper is being calibrated.
    Calibrating,
}

decision_table! {
    /// QC-LIFT: second part of QC-ATTACH (V.2.1), with the gripper mated: lock, close the gripper, back, lift, up,
    /// calibrate if required. Done at once if the gripper is locked and clear of its holster.
    pub QC_LIFT: fn qc_lift(self::QcAttachStep, struct of super::Senses) -> super::Action or () {
        any {
            1:  mate: None | Wrong                                    => consult;
        }
        Start {
            2:  at: There, holster: Empty, lock: Locked               => Finish;
            3:  along: Off, holster: Empty, lock: Locked              => Finish;
            4:  along: Off, holster: Empty, lock: Unlocked | Between  => Fail(RingNotLocked);
        }
        any {
            5:  along: Off | Above | Out                              => Fail(NotPrepared);
        }
        Mating {
            6:  along: Seat                                           => Lock                -> Locking;
        }
        Locking {
            7:  along: Seat, lock: Unlocked | Between                 => FailRing;
        }
        any {
            8:  along: Lifting | Raising | Clear, lock: Unlocked | Between => Fail(RingNotLocked);
            // EXCHANGE excludes a faulty ring.
            9:  along: Coming, lock: Locked | Between | Faulty        => Fail(RingNotLocked);
            // Only at the seat can the ring catch the gripper.
            10: lock: Unlocked | Between                              => DeltaMove(QcaSlow)  -> Mating;
        }
        Closing | Backing {
            11: along: Seat | Sliding                                 => DeltaMove(QcaBack)  -> Backing;
        }
        any {
            12: along: Seat | Sliding, shut: Open                     => CloseForHolster     -> Closing;
            13: along: Seat | Sliding                                 => DeltaMove(QcaBack)  -> Backing;
        }
        Lifting | Raising {
            14: along: Lifting                                        => DeltaMove(QcaUp)    -> Raising;
        }
        any {
            15: along: Low | Lifting                                  => DeltaMove(QcaLift)  -> Lifting;
            16: along: Raising                                        => DeltaMove(QcaUp)    -> Raising;
        }
        Calibrating {
            17: readiness: Uncalibrated                               => FailGrip;
        }
        any {
            18: readiness: Uncalibrated                               => Calibrate           -> Calibrating;
            19: readiness: Ready                                      => Stand;
            20: readiness: Faulty                                     => FailGrip;
        }
    }
}

decision_table! {
    /// QC-ATTACH (V.2.1): down fast, down slowly, lock, close the gripper, back, lift, check the id, up, calibrate if
    /// required. The next action depends on the robot's position in the holster and on gripper and ring, so that a
    /// repeated command continues (docs/design/recovery.md "Exchange"). An order without effect ends the command.
    /// This table moves the bare robot onto the gripper; QC-LIFT, which is consulted before, continues once the
    /// gripper is mated. A bare robot that has found no gripper leaves upward.
    pub QC_ATTACH: fn qc_attach(self::QcAttachStep, struct of super::Senses) -> super::Action {
        Start {
            1:  mate: Wrong                                       => Fail(WrongGripper);
        }
        any {
            2:  mate: Wrong                                       => Fail(WrongGripperId);
            3:  along: Off                                        => Fail(NotPrepared);
        }
        Start | Leaving {
            4:  along: Above, holster: Empty | Partial            => Leave(HolsterEmpty);
        }
        Start {
            5:  along: Out, holster: Partial                      => DeltaMove(QcdOut)   -> Leaving;
            6:  along: Out | Coming | Seat, holster: Empty        => DeltaMove(QcdOut)   -> Leaving;
        }
        Unlocking {
            7:  along: Above | Out | Coming | Seat, lock: Locked | Between => FailRing;
        }
        any {
            // At the seat the ring may hold a gripper whose id pins have no contact.
            8:  along: Above | Out | Coming | Seat, lock: Locked | Between => Unlock -> Unlocking;
        }
        Approaching | Mating {
            9:  along: Above | Out                                => DeltaMove(QcaSlow)  -> Mating;
        }
        Undoing {
            10: along: Out | Coming                               => DeltaMove(QcdOut)   -> Leaving;
        }
        Leaving {
            11: along: Above                                      => Leave(NotAttached);
            12: along: Out | Coming | Seat                        => Fail(NoEffect);
        }
        any {
            13: along: Above | Out                                => DeltaMove(QcaFast)  -> Approaching;
            14: along: Coming                                     => DeltaMove(QcaSlow)  -> Mating;
            15: along: Seat                                       => DeltaMove(QcaFast)  -> Undoing;
            16: along: Sliding | Low | Lifting | Raising | Clear  => Fail(NotAttached);
        }
    }
}
