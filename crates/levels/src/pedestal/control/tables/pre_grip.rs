use rcs_core::decision_table;

decision_table! {
    /// PRE-GRIP (VI.7.1): open the hand to `grasp-size` and turn the table to the absolute `table-angle`, both at
    /// once. An uncalibrated hand is calibrated first, unless it was commanded to grip: UP-INIT would close on the
    /// object with the whole supply pressure.
    pub PRE_GRIP: fn pre_grip(enum PreGripStep, super::Situation) -> super::Action {
        /// No command sent yet.
        Start {
            1: calibration: Known                  => OpenAndTurn  -> Moving;
            2: calibration: Missing, gripped: No   => Calibrate    -> Calibrating;
            3: calibration: Missing, gripped: Yes  => Fail(HandNotCalibrated);
        }
        /// The hand is being calibrated.
        Calibrating {
            4: calibration: Known                  => OpenAndTurn  -> Moving;
            5: calibration: Missing                => Fail(HandNotCalibrated);
        }
        /// The hand opens, the table turns.
        Moving {
            6: otherwise                           => Finish;
        }
    }
}
