//! Preconditions of a motion and of the calibration of the force sensor: T3I, E-move, the link, and a position.
//!
//! ```text
//!                    an error of the link, or no position: RESTART
//!   +------------+ ------------------------------------------------> +------------+
//!   | Commanding |                                                   | Restarting |
//!   +------------+ <------------------------------------------------ +------------+
//!              report: the robot is where it was sent; on from rest
//! ```

use rcs_core::decision_table;

decision_table! {
    /// LINK (V.1.2 restart-status): Prim restarts a failed link while the command stays in execution, and then
    /// continues from rest at the robot's position. A restart without a report, too many restarts, and a controller
    /// with DTR off are a lost link. If the robot is not at its commanded position, or has left its path, the
    /// operator decides.
    pub LINK: fn link(enum LinkStep, super::Situation) -> super::Action or () {
        any {
            1:  position: NotNeeded                              => consult;
            2:  t3i: Silent                                      => Fail(InterfaceSilent)   -> Commanding;
            3:  t3i: LinkOff                                     => Fail(LinkOff)           -> Commanding;
            4:  emove: Lost                                      => Fail(NeighbourLost)     -> Commanding;
            5:  operator: Moves                                  => Yield                   -> Commanding;
            6:  t3i: OffPath                                     => Fail(OffPath)           -> Commanding;
            7:  t3i: LinkSilent, restarts: Many                  => Fail(LinkOff)           -> Commanding;
            8:  t3i: LinkError, restarts: Many                   => Fail(LinkError)         -> Commanding;
            9:  t3i: Refused, restarts: Many                     => Fail(InterfaceRefused)  -> Commanding;
        }
        /// The command needs no restart.
        Commanding {
            10: t3i: LinkSilent | LinkError | Refused            => Recover                 -> Restarting;
            11: posture: Unpositioned, restarts: Few             => Recover                 -> Restarting;
            12: posture: Unpositioned, restarts: Many            => Fail(LinkError);
            13: posture: Moving | Ending | Standing              => consult;
        }
        /// RESTART is sent; the robot's position must be reported.
        Restarting {
            14: t3i: LinkSilent, report: NoReport                => Fail(LinkOff)           -> Commanding;
            15: t3i: LinkError, report: NoReport                 => Fail(LinkError)         -> Commanding;
            16: t3i: LinkSilent | LinkError, report: AsSent | Elsewhere => Recover;
            17: t3i: Refused                                     => Recover;
            18: t3i: Busy | Ready | Finished, report: NoReport   => Wait;
            19: t3i: Busy | Ready | Finished, report: AsSent     => Resume                  -> Commanding;
            20: t3i: Busy | Ready | Finished, report: Elsewhere  => Fail(RobotElsewhere)    -> Commanding;
        }
    }
}
