//! QC-ATTACH (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// QC-ATTACH (V.2.1): down fast, down slowly, lock, close the gripper, back, lift, check the id, up,
    /// calibrate if required. What is done next depends on where the robot is in the holster and on what is
    /// mated and locked, so that a command that is sent again goes on (docs/design/recovery.md "Exchange");
    /// an order that has changed nothing ends it. A bare robot that has found no gripper leaves upward. Done
    /// at once if the gripper is locked on and clear of its holster.
    pub QC_ATTACH: fn qc_attach(enum QcAttachStep, super::Situation) -> super::Action {
        any {
            1:  work: Busy                                                => Wait;
            2:  lock: Faulty                                              => FailRing;
        }
        /// Nothing done yet.
        Start {
            3:  mate: Wrong                                               => Fail(WrongGripper);
            4:  mate: Right, at: There, holster: Empty, lock: Locked      => Finish;
            5:  mate: Right, along: Off, holster: Partial | Full          => Fail(NotPrepared);
            6:  mate: Right, along: Off, holster: Empty, lock: Locked     => Finish;
            7:  mate: Right, along: Off, holster: Empty, lock: Unlocked | Between => Fail(RingNotLocked);
            8:  mate: None, along: Above, holster: Empty | Partial        => Leave(HolsterEmpty);
            9:  mate: None, along: Out, holster: Partial                  => DeltaMove(QcdOut) -> Leaving;
            10: mate: None, along: Out | Coming | Seat, holster: Empty    => DeltaMove(QcdOut) -> Leaving;
        }
        any {
            11: mate: Wrong                                               => Fail(WrongGripperId);
            12: along: Off                                                => Fail(NotPrepared);
            13: mate: Right, along: Above | Out                           => Fail(NotPrepared);
        }
        /// The quick change of the bare robot is unlocking.
        Unlocking {
            14: mate: None, along: Above | Out | Coming | Seat, lock: Locked | Between => FailRing;
        }
        any {
            // At the seat the ring may hold a gripper whose id pins have no contact.
            15: mate: None, along: Above | Out | Coming | Seat, lock: Locked | Between => Unlock -> Unlocking;
        }
        /// The robot is moving close to the gripper.
        Approaching {
            16: mate: None, along: Above | Out | Coming                   => DeltaMove(QcaSlow) -> Mating;
        }
        /// The seat was empty: the robot moves away from it.
        Undoing {
            17: mate: None, along: Out | Coming                           => DeltaMove(QcdOut) -> Leaving;
        }
        /// The bare robot moves up out of the holster.
        Leaving {
            18: mate: None, along: Above, holster: Empty | Partial        => Leave(HolsterEmpty);
            19: mate: None, along: Above, holster: Full                   => Leave(NotAttached);
            20: mate: None, along: Out | Coming | Seat                    => Fail(NoEffect);
        }
        /// The robot is moving slowly onto the gripper.
        Mating {
            21: mate: None, along: Above | Out                            => Fail(NoEffect);
            22: mate: Right, along: Seat                                  => Lock -> Locking;
        }
        any {
            23: mate: None, along: Above | Out                          => DeltaMove(QcaFast) -> Approaching;
            24: mate: None, along: Coming                                 => DeltaMove(QcaSlow) -> Mating;
            25: mate: None, along: Seat                                   => DeltaMove(QcaFast) -> Undoing;
            26: mate: None, along: Sliding | Low                          => Fail(NotAttached);
            27: mate: None, along: Lifting | Raising | Clear              => Fail(NotAttached);
            28: mate: Right, along: Coming | Sliding | Low, lock: Unlocked => DeltaMove(QcaSlow) -> Mating;
            29: mate: Right, along: Coming, lock: Locked | Between        => Fail(RingNotLocked);
            30: mate: Right, along: Sliding | Low, lock: Between          => DeltaMove(QcaSlow) -> Mating;
            31: along: Lifting | Raising | Clear, lock: Unlocked | Between => Fail(RingNotLocked);
        }
        /// The quick change is locking.
        Locking {
            32: mate: Right, along: Seat, lock: Unlocked | Between        => FailRing;
        }
        /// The gripper is closing.
        Closing {
            33: mate: Right, along: Seat | Sliding, lock: Locked          => DeltaMove(QcaBack) -> Backing;
        }
        /// The gripper is sliding back out of its seat.
        Backing {
            34: mate: Right, along: Low | Lifting, lock: Locked           => DeltaMove(QcaLift) -> Lifting;
            35: mate: Right, along: Seat | Sliding, lock: Locked          => Fail(NoEffect);
        }
        any {
            // Near the seat is not at it, and the ring would catch nothing.
            36: mate: Right, along: Seat, lock: Unlocked | Between        => DeltaMove(QcaSlow) -> Mating;
            37: mate: Right, along: Seat | Sliding, lock: Locked, shut: Open => CloseForHolster -> Closing;
            38: mate: Right, along: Seat | Sliding, lock: Locked           => DeltaMove(QcaBack) -> Backing;
        }
        /// It is being lifted a distance out of the holster.
        Lifting {
            39: mate: Right, along: Lifting | Raising, lock: Locked       => DeltaMove(QcaUp) -> Raising;
        }
        /// It is being lifted completely out of the holster.
        Raising {
            40: along: Clear, readiness: Uncalibrated                     => Calibrate -> Calibrating;
            41: mate: Right, along: Lifting, lock: Locked                 => Fail(NoEffect);
        }
        any {
            42: mate: Right, along: Low | Lifting, lock: Locked           => DeltaMove(QcaLift) -> Lifting;
            43: mate: Right, along: Raising, lock: Locked                 => DeltaMove(QcaUp) -> Raising;
        }
        /// It is being calibrated.
        Calibrating {
            44: along: Clear, readiness: Uncalibrated                     => FailGrip;
        }
        any {
            45: along: Clear, readiness: Uncalibrated                     => Calibrate -> Calibrating;
            46: along: Clear, readiness: Ready                            => Stand;
            47: along: Clear, readiness: Faulty                           => FailGrip;
        }
    }
}
