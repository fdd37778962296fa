use rcs_core::decision_table;

decision_table! {
    /// ROBOT-INIT (V.1.1): RESTART to T3I. It clears the errors of the link, so that only those after the RESTART
    /// count, and ends the stop of a robot that left its path. The reported position is taken over, wherever the
    /// robot is: so work continues after the robot was moved by other means. The joystick box has no effect on it.
    pub ROBOT_INIT: fn robot_init(enum RobotInitStep, super::Situation) -> super::Action {
        /// No RESTART sent yet.
        Start {
            1:  t3i: LinkOff | LinkSilent | LinkError | OffPath | Refused  => Restart  -> Restarting;
        }
        any {
            2:  t3i: Silent                                                => Fail(InterfaceSilent);
            3:  t3i: LinkOff                                               => Fail(LinkOff);
            4:  t3i: LinkSilent,             report: NoReport              => Fail(LinkOff);
            5:  t3i: LinkError,              report: NoReport              => Fail(LinkError);
            6:  t3i: LinkSilent | LinkError, restarts: Many                => Fail(LinkError);
            7:  t3i: LinkSilent | LinkError, restarts: Few                 => Recover;
            8:  t3i: Refused                                               => Fail(InterfaceRefused);
            9:  t3i: OffPath                                               => Fail(OffPath);
            10: emove: Lost                                                => Fail(NeighbourLost);
        }
        Start {
            11: posture: Unpositioned | Standing                           => Restart  -> Restarting;
            12: posture: Moving | Ending                                   => Halt;
        }
        /// RESTART is sent. If the link fails after its report, it is restarted again.
        Restarting {
            13: link: Down                                                 => Wait;
            14: link: Running                                              => TakePosition;
        }
    }
}
