//! What hinders every motion, and the calibration of the force sensor.

use rcs_core::decision_table;

decision_table! {
    /// HINDRANCE: T3I or E-move fails, the operator takes the robot, or Prim has no position. The robot
    /// stops, and the command has failed.
    pub HINDRANCE: fn hindrance(super::Situation) -> super::Action or () {
        1: t3i: Silent                                      => Fail(InterfaceSilent);
        2: t3i: LinkOff                                     => Fail(LinkOff);
        3: t3i: LinkError                                   => Fail(LinkError);
        4: t3i: Refused                                     => Fail(InterfaceRefused);
        5: emove: Lost                                      => Fail(NeighbourLost);
        6: switches: One | Several                          => Yield;
        7: posture: Unpositioned                            => Fail(LinkOff);
        8: posture: Moving | Ending | Standing              => consult;
    }
}
