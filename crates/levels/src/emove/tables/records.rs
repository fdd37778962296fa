//! Task data of a command, and its path, before anything moves.

use rcs_core::decision_table;

decision_table! {
    /// RECORDS: a new command that ACCEPT has not refused is refused if a record that it needs is missing, or if there
    /// is no path to its goal. While the operator has the robot, only E-PAUSE is accepted: fingers and ring must not
    /// move at a place that the process above does not know.
    pub RECORDS: fn records(super::Records) -> super::Action or () {
        1:  sizes: Missing              => Refuse(UnknownGrip);
        2:  view: Missing               => Refuse(BadRecord);
        3:  holster: NoGripper          => Refuse(NoHolster);
        4:  holster: NoOpening          => Refuse(UnknownGrip);
        5:  moves: Missing              => Refuse(NoRelativeMove);
        6:  moves: Unguarded            => Refuse(UnknownSensor);
        7:  moves: NoPose               => Refuse(NoDestination);
        8:  route: NoPose               => Refuse(NoDestination);
        9:  route: BadPose | NoView     => Refuse(BadRecord);
        10: route: NoSizes              => Refuse(UnknownGrip);
        11: route: NoGrip               => Refuse(NoGripMovetable);
        12: route: NoApproach | NoSpeed => Refuse(NoApproach);
        13: route: NoStart              => Refuse(UnknownStart);
        14: route: ForwardOnly          => Refuse(ForwardOnly);
        15: route: InDrum               => Refuse(NotPrepared);
        16: route: NoTrajectory         => Refuse(NoTrajectory);
        17: route: OffPlace             => Refuse(OffPlace);
        18: joystick: Off               => consult;
        19: joystick: On, pause: Other  => Manual;
        20: pause: UnderWay | Standing  => consult;
    }
}
