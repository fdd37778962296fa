//! PAUSE (V.1.1), with the joystick box (III.3.3).

use rcs_core::decision_table;

decision_table! {
    /// PAUSE (V.1.1): do nothing. A motion ramps down within its limits; then the last point is repeated.
    /// From there on the joystick box moves the robot while one of its frame switches is on. A link that
    /// fails meanwhile, or a robot that leaves its path, is reported; the next motion restarts the link.
    pub PAUSE: fn pause(enum PauseStep, super::Situation) -> super::Action {
        any {
            1:  t3i: Silent                                         => Fail(InterfaceSilent);
            2:  t3i: LinkOff | LinkSilent                           => Fail(LinkOff);
            3:  t3i: LinkError                                      => Fail(LinkError);
            4:  t3i: Refused                                        => Fail(InterfaceRefused);
            5:  t3i: OffPath                                        => Fail(OffPath);
            6:  posture: Unpositioned | Standing, switches: Off     => Finish   -> Start;
            7:  posture: Unpositioned | Standing, switches: Several => Yield    -> Start;
            8:  posture: Unpositioned, switches: One                => Yield    -> Start;
            9:  posture: Standing, switches: One                    => Drive    -> Driving;
        }
        /// Nothing done yet, or nothing to do.
        Start {
            10: switches: Off                                       => Halt     -> Stopping;
        }
        /// The motion of the command before ramps down.
        Stopping {
            11: switches: Off                                       => Wait;
        }
        Start | Stopping {
            12: switches: One | Several                             => Yield    -> Stopping;
        }
        /// The box moves the robot.
        Driving {
            13: switches: One                                       => Drive;
            14: switches: Several                                   => Yield;
            15: switches: Off                                       => Wait;
        }
    }
}
