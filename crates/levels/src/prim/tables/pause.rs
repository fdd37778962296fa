//! PAUSE (V.1.1), with the joystick box (III.3.3).

use rcs_core::decision_table;

decision_table! {
    /// PAUSE (V.1.1): do nothing. A motion ramps down within its limits; then the last point is repeated. The
    /// command is done when the resolvers show that the robot rests. From then on the joystick box moves the robot
    /// while one of its frame switches is on. A link failure, or a robot that leaves its path, is reported; the
    /// next motion restarts the link.
    pub PAUSE: fn pause(enum PauseStep, super::Situation) -> super::Action {
        any {
            1:  t3i: Silent                                                  => Fail(InterfaceSilent);
            2:  t3i: LinkOff | LinkSilent                                    => Fail(LinkOff);
            3:  t3i: LinkError                                               => Fail(LinkError);
            4:  t3i: Refused                                                 => Fail(InterfaceRefused);
            5:  t3i: OffPath                                                 => Fail(OffPath);
            6:  posture: Unpositioned,            switches: Off              => Finish  -> Resting;
            7:  posture: Unpositioned | Standing, switches: Several          => Yield   -> Start;
            8:  posture: Unpositioned,            switches: One              => Yield   -> Start;
            9:  posture: Standing,                switches: One              => Drive   -> Driving;
        }
        /// No motion has to stop, or the command is not done yet.
        Start {}
        /// The motion of the previous command ramps down.
        Stopping {}
        /// The box moves the robot.
        Driving {}
        Start | Stopping | Driving {
            10: posture: Standing, switches: Off, rest: UnderWay | Settling  => Wait;
            11: posture: Standing, switches: Off, rest: Arrived              => Finish  -> Resting;
            12: posture: Standing, switches: Off, rest: Late                 => Fail(NotAtGoal);
        }
        /// The robot is at rest.
        Resting {
            13: posture: Standing, switches: Off                             => Finish;
        }
        Start | Resting {
            14: switches: Off                                                => Halt    -> Stopping;
        }
        Stopping {
            15: switches: Off                                                => Wait;
        }
        Start | Stopping | Resting {
            16: switches: One | Several                                      => Yield   -> Stopping;
        }
        Driving {
            17: switches: One                                                => Drive;
            18: switches: Several                                            => Yield;
            19: switches: Off                                                => Wait;
        }
    }
}
