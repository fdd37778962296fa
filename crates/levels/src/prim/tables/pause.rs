//! PAUSE (V.1.1), with the joystick box (III.3.3).

use rcs_core::decision_table;

decision_table! {
    /// PAUSE (V.1.1): do nothing. A motion ramps down within its limits; then the last point is repeated.
    /// From there on the joystick box moves the robot while one of its frame switches is on.
    pub PAUSE: fn pause(enum PauseStep, super::Situation) -> super::Action {
        any {
            1:  posture: Unpositioned | Standing, switches: Off     => Finish   -> Start;
            2:  posture: Unpositioned | Standing, switches: Several => Yield    -> Start;
            3:  posture: Unpositioned, switches: One                => Yield    -> Start;
            4:  posture: Standing, switches: One                    => Drive    -> Driving;
        }
        /// Nothing done yet, or nothing to do.
        Start {
            5:  switches: Off                                       => Halt     -> Stopping;
        }
        /// The motion of the command before ramps down.
        Stopping {
            6:  switches: Off                                       => Wait;
        }
        Start | Stopping {
            7:  switches: One | Several                             => Yield    -> Stopping;
        }
        /// The box moves the robot.
        Driving {
            8:  switches: One                                       => Drive;
            9:  switches: Several                                   => Yield;
            10: switches: Off                                       => Wait;
        }
    }
}
