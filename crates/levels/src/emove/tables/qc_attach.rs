//! QC-ATTACH (V.2.1).

use rcs_core::decision_table;

decision_table! {
    /// QC-ATTACH (V.2.1): down fast, down slowly, lock, close the gripper, back, lift, check the id, up,
    /// calibrate if required. A gripper that is not calibrated cannot be told to close: it is taken out as it was
    /// put in. Done at once if the gripper is locked on and clear of its holster. A bare robot
    /// whose ring is locked is unlocked first.
    pub QC_ATTACH: fn qc_attach(enum QcAttachStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                                            => Wait;
        }
        /// Nothing done yet.
        Start {
            2: mate: Wrong                                           => Fail(WrongGripper);
            3: mate: Right, holster: Partial | Full                  => Fail(NotPrepared);
            4: mate: Right, ring: Locked                             => Finish;
            5: mate: Right, ring: Busy | Unlocked | Faulty           => FailRing;
            6: mate: None, at: Elsewhere | InDrum                    => Fail(NotPrepared);
            7: mate: None, at: There, holster: Empty | Partial       => Fail(HolsterEmpty);
            8: mate: None, at: There, holster: Full, ring: Busy      => Wait;
            9: mate: None, at: There, holster: Full, ring: Faulty    => FailRing;
            10: mate: None, at: There, holster: Full, ring: Locked   => Unlock             -> Unlocking;
            11: mate: None, at: There, holster: Full, ring: Unlocked => DeltaMove(QcaFast) -> Approaching;
        }
        /// The quick change of the bare robot is unlocking.
        Unlocking {
            12: ring: Unlocked                                       => DeltaMove(QcaFast) -> Approaching;
            13: ring: Busy | Locked | Faulty                         => FailRing;
        }
        /// The robot is moving close to the gripper.
        Approaching {
            14: work: Over                                           => DeltaMove(QcaSlow) -> Mating;
        }
        /// It is moving slowly onto the gripper.
        Mating {
            15: work: Over                                           => Lock               -> Locking;
        }
        /// The quick change is locking.
        Locking {
            16: ring: Locked, readiness: Uncalibrated                => DeltaMove(QcaBack) -> Backing;
            17: ring: Locked                                         => CloseForHolster    -> Closing;
            18: ring: Busy | Unlocked | Faulty                       => FailRing;
        }
        /// The gripper is closing.
        Closing {
            19: work: Over                                           => DeltaMove(QcaBack) -> Backing;
        }
        /// The gripper is sliding back out of its seat.
        Backing {
            20: work: Over                                           => DeltaMove(QcaLift) -> Lifting;
        }
        Lifting | Raising {
            21: mate: None                                           => Fail(NotAttached);
            22: mate: Wrong                                          => Fail(WrongGripperId);
        }
        /// It is being lifted a distance out of the holster.
        Lifting {
            23: ring: Locked                                         => DeltaMove(QcaUp)   -> Raising;
            24: ring: Busy | Unlocked | Faulty                       => FailRing;
        }
        /// It is being lifted completely out of it.
        Raising {
            25: readiness: Uncalibrated                              => Calibrate          -> Calibrating;
        }
        /// It is being calibrated.
        Calibrating {
            26: readiness: Uncalibrated                              => FailGrip;
        }
        Raising | Calibrating {
            27: readiness: Ready                                     => Stand;
            28: readiness: Faulty                                    => FailGrip;
        }
    }
}
