//! The way to a goal, shared by the MOV-… commands.

use rcs_core::decision_table;

decision_table! {
    /// MOTION: a series of GO-THRU and one GOTO-PT (V.2.1 MOV-TO-LOC). If the goal asks for an opening, the
    /// fingers are brought to it once the last depart point is behind, and the final motion waits for them. A
    /// gripper that is not calibrated and holds nothing is calibrated on the way: nothing is between its
    /// fingers there.
    pub MOTION: fn motion(enum MotionStep, super::Situation) -> super::Action {
        any {
            1: work: Busy                                         => Wait;
        }
        /// On the way through points; nothing commanded yet at first.
        Moving {
            2: opening: Uncalibrated                              => Calibrate;
            3: opening: Due                                       => Open;
            4: opening: LettingGo, ahead: Through | Stop | Beside => Fail(ReleaseNotEnded);
            5: ahead: Through                                     => GoThru;
            6: ahead: Missing                                     => Fail(BadRecord);
            7: ahead: Stop | Nothing, opening: Departing | Moving => Wait;
            8: ahead: Stop                                        => GotoPt -> Stopping;
            9: ahead: Nothing                                     => Arrive;
            10: ahead: Beside                                     => GotoPt -> Rejoining;
        }
        /// On the final motion.
        Stopping {
            11: otherwise                                        => Arrive;
        }
        /// Back to the way beside which a person has left the robot.
        Rejoining {
            12: otherwise                                        => Wait -> Moving;
        }
    }
}
