//! Motion of the fingers on the path to a goal.

use rcs_core::decision_table;

decision_table! {
    /// FINGERS: if the goal needs an opening, the fingers move to it after the last depart point, and the final
    /// motion waits for them (docs/design/motion.md "Finger opening"). An uncalibrated empty gripper is calibrated on
    /// the way, where its fingers are free. An unfinished release must end first.
    pub FINGERS: fn fingers(super::motion::MotionStep, struct of super::Senses) -> super::Action or () {
        any {
            1:  work: Busy                                                          => consult;
        }
        Moving {
            2:  release: UnderWay, ahead: Through | Stop | Rejoin                   => Fail(ReleaseNotEnded);
            3:  opening: Free | Reached                                             => consult;
            4:  opening: Sent, gripper: Pending | Executing, ahead: Stop | Nothing  => Wait;
            5:  opening: Sent                                                       => consult;
            6:  departure: UnderWay                                                 => consult;
            7:  calibration: Missing, held: Nothing, departure: Over                => Calibrate;
            8:  calibration: Missing, held: Nothing, departure: AtPlace, ahead: Through => consult;
            9:  opening: Due                                                        => Open;
        }
        Stopping | Rejoining {
            10: otherwise                                                           => consult;
        }
    }
}
