//! QC-ATTACH (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// QC-ATTACH (V.2.1): down fast, down slowly, lock, close the gripper, back, lift, check the id, up,
    /// calibrate if required. What is done next depends on where the robot is in the holster and on what is
    /// mated and locked, so that a command that is sent again goes on (docs/design/recovery.md "Exchange"); an
    /// order that has changed nothing ends it. Done at once if the gripper is locked on and clear of its holster.
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
            8:  mate: None, along: Above | Out, holster: Empty | Partial  => Fail(HolsterEmpty);
        }
        any {
            9:  mate: Wrong                                               => Fail(WrongGripperId);
            10: along: Off                                                => Fail(NotPrepared);
            11: mate: Right, along: Above | Out                           => Fail(NotPrepared);
        }
        /// The quick change of the bare robot is unlocking.
        Unlocking {
            12: mate: None, along: Above | Out | Coming, lock: Locked | Between => FailRing;
        }
        any {
            13: mate: None, along: Above | Out | Coming, lock: Locked | Between => Unlock -> Unlocking;
        }
        /// The robot is moving close to the gripper.
        Approaching {
            14: mate: None, along: Above | Out | Coming                   => DeltaMove(QcaSlow) -> Mating;
        }
        /// The seat was empty: the robot moves away from it.
        Undoing {
            15: mate: None, along: Above | Out | Coming                   => Fail(NotAttached);
        }
        /// The robot is moving slowly onto the gripper.
        Mating {
            16: mate: None, along: Above | Out                            => Fail(NoEffect);
            17: mate: Right, along: Seat                                  => Lock -> Locking;
        }
        any {
            18: mate: None, along: Above | Out                          => DeltaMove(QcaFast) -> Approaching;
            19: mate: None, along: Coming                                 => DeltaMove(QcaSlow) -> Mating;
            20: mate: None, along: Seat                                   => DeltaMove(QcaFast) -> Undoing;
            21: mate: None, along: Sliding | Low                          => Fail(NotAttached);
            22: mate: None, along: Lifting | Raising | Clear              => Fail(NotAttached);
            23: mate: Right, along: Coming | Sliding | Low, lock: Unlocked => DeltaMove(QcaSlow) -> Mating;
            24: mate: Right, along: Coming, lock: Locked | Between        => Fail(RingNotLocked);
            25: mate: Right, along: Sliding | Low, lock: Between          => DeltaMove(QcaSlow) -> Mating;
            26: along: Lifting | Raising | Clear, lock: Unlocked | Between => Fail(RingNotLocked);
        }
        /// The quick change is locking.
        Locking {
            27: mate: Right, along: Seat, lock: Unlocked | Between        => FailRing;
        }
        /// The gripper is closing.
        Closing {
            28: mate: Right, along: Seat | Sliding, lock: Locked          => DeltaMove(QcaBack) -> Backing;
        }
        /// The gripper is sliding back out of its seat.
        Backing {
            29: mate: Right, along: Low | Lifting, lock: Locked           => DeltaMove(QcaLift) -> Lifting;
            30: mate: Right, along: Seat | Sliding, lock: Locked          => Fail(NoEffect);
        }
        any {
            31: mate: Right, along: Seat, lock: Unlocked | Between        => Lock -> Locking;
            32: mate: Right, along: Seat | Sliding, lock: Locked, shut: Open => CloseForHolster -> Closing;
            33: mate: Right, along: Seat | Sliding, lock: Locked           => DeltaMove(QcaBack) -> Backing;
        }
        /// It is being lifted a distance out of the holster.
        Lifting {
            34: mate: Right, along: Lifting | Raising, lock: Locked       => DeltaMove(QcaUp) -> Raising;
        }
        /// It is being lifted completely out of the holster.
        Raising {
            35: along: Clear, readiness: Uncalibrated                     => Calibrate -> Calibrating;
            36: mate: Right, along: Lifting, lock: Locked                 => Fail(NoEffect);
        }
        any {
            37: mate: Right, along: Low | Lifting, lock: Locked           => DeltaMove(QcaLift) -> Lifting;
            38: mate: Right, along: Raising, lock: Locked                 => DeltaMove(QcaUp) -> Raising;
        }
        /// It is being calibrated.
        Calibrating {
            39: along: Clear, readiness: Uncalibrated                     => FailGrip;
        }
        any {
            40: along: Clear, readiness: Uncalibrated                     => Calibrate -> Calibrating;
            41: along: Clear, readiness: Ready                            => Stand;
            42: along: Clear, readiness: Faulty                           => FailGrip;
        }
    }
}
