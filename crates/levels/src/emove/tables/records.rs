//! Task data of a command, and its path, before anything moves.

use rcs_core::{Plain, Variables, decision_table};

use super::Pause;
use crate::{
    emove::motion::{relative::RelativeMoves, route::Planning},
    halt::BoxState,
};

/// A record of the task data that a command names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveRecord {
    /// The record exists, or is not needed.
    Found,
    /// The record is missing.
    Missing,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum HolsterData {
    /// The data are complete.
    Found,
    /// No gripper has the number that the command names.
    NoGripper,
    /// The task data have no opening of the gripper for the path through its holster.
    NoOpening,
}

/// Results of the look-up in the task data, for [`RECORDS`]. A record that a command does not need is found.
#[derive(Clone, Copy, Debug, Default, Variables)]
pub struct Records {
    /// Sizes of object and grip for GRASP-OBJ and ACQUIRE-TOOL: END-EFF-PARA.
    pub sizes: EmoveRecord,
    /// View of the object for LOCATE-OBJ: VISION-PARA.
    pub view: EmoveRecord,
    /// The gripper's holster for QC-ATTACH and QC-DETACH.
    pub holster: HolsterData,
    /// The relative moves of the command.
    pub moves: RelativeMoves,
    /// The path to the goal.
    pub route: Planning,
    /// The joystick box.
    pub joystick: BoxState,
    /// Progress of E-PAUSE, if it is the command.
    pub pause: Pause,
}

decision_table! {
    /// RECORDS: a new command is refused if a record that it needs is missing, or if its goal has no path. While the
    /// operator has the robot, only E-PAUSE is accepted: fingers and ring must not move at a place that Subtask does
    /// not know.
    pub RECORDS: fn records(self::Records) -> super::Action or () {
        1:  sizes: Missing               => Refuse(UnknownGrip);
        2:  view: Missing                => Refuse(BadRecord);
        3:  holster: NoGripper           => Refuse(NoHolster);
        4:  holster: NoOpening           => Refuse(UnknownGrip);
        5:  moves: Missing               => Refuse(NoRelativeMove);
        6:  moves: Unguarded             => Refuse(UnknownSensor);
        7:  moves: NoPose                => Refuse(NoDestination);
        8:  route: NoPose                => Refuse(NoDestination);
        9:  route: BadPose | NoView      => Refuse(BadRecord);
        10: route: NoSizes               => Refuse(UnknownGrip);
        11: route: NoGrip                => Refuse(NoGripMovetable);
        12: route: NoApproach | NoSpeed  => Refuse(NoApproach);
        13: route: NoStart               => Refuse(UnknownStart);
        14: route: ForwardOnly           => Refuse(ForwardOnly);
        15: route: InDrum                => Refuse(NotPrepared);
        16: route: NoTrajectory          => Refuse(NoTrajectory);
        17: route: OffPlace              => Refuse(OffPlace);
        18: joystick: Off                => consult;
        19: joystick: On, pause: Other   => Manual;
        20: pause: UnderWay | Standing   => consult;
    }
}
