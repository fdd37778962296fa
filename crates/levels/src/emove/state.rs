//! What E-move remembers from tick to tick.

use rcs_core::{
    Plain,
    handshake::Commander,
    interface::{prim::JoystickGrip, subtask::LocationKind},
    name::{Name10, Name16},
    pose::Pose,
};
use taskdata::files::{EndEffId, Place};

use super::{
    gripper::{Gripper, Grippers},
    route::Route,
};
use crate::{old_execution::Execution, places::place_of};

/// What the last completed move went to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Sort {
    /// A location as such.
    Location,
    /// An object at a location, or a held object's destination.
    Object,
    /// The place from which pictures of an object are taken.
    View,
    /// The tool drum, with the fingers around a tool in it: only the tool commands lead away from there.
    Drum,
}

/// Where the robot is (docs/design/motion.md "Where the robot is"):
/// location, object and grip of the last completed move. It decides how
/// the robot departs.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Stance {
    /// The robot is there.
    pub known: bool,
    /// What was gone to.
    pub sort: Sort,
    /// Name of the location.
    pub location: Name10,
    /// Its type.
    pub kind: LocationKind,
    /// Record of LOCPT.
    pub record: u32,
    /// Record of ARRAY-TABLE.
    pub array: u32,
    /// The object; empty for none.
    pub object: Name16,
    /// Its grip.
    pub grip: i32,
    /// Where the move ended.
    pub pose: Pose,
}

impl Stance {
    /// The place as task data knows it.
    #[must_use]
    pub const fn place(&self) -> Place {
        place_of(self.kind, self.record, self.array)
    }
}

/// What the gripper holds.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Held {
    /// The object; empty for none.
    pub object: Name16,
    /// Its record of END-EFF-PARA.
    pub parameters: EndEffId,
    /// The gripper that holds it.
    pub gripper: Gripper,
    /// Grasp size of the object, 0.01 in: what [`Gripper::grips`] is asked about.
    pub grasp_size: i32,
    /// Opening when it was grasped, 0.01 in.
    pub opening: i32,
    /// Ticks in which neither finger has felt it.
    pub unfelt: u8,
}

/// An object that vision has located and that has not been grasped since.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Located {
    /// The object; empty for none.
    pub object: Name16,
    /// Record of LOCPT where it is.
    pub record: u32,
    /// Record of ARRAY-TABLE where it is.
    pub array: u32,
    /// Its part frame.
    pub pose: Pose,
}

/// State of E-move.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The command of Subtask and how far it has come.
    pub execution: Execution,
    /// Commands to Prim.
    pub prim: Commander,
    /// Commands to the gripper processes.
    pub grippers: Grippers,
    /// Commands to Quick Change.
    pub quick_change: Commander,
    /// Requests to vision: number and tick of the last one.
    pub vision: Commander,
    /// Pictures taken in vain in this step.
    pub tries: u8,
    /// The way to the goal of the current command.
    pub route: Route,
    /// Where the robot is.
    pub stance: Stance,
    /// How many location points have been looked at to find out where the robot is.
    pub searched: u32,
    /// What the gripper holds.
    pub held: Held,
    /// What vision has located.
    pub located: Located,
    /// Something was held when the current command came.
    pub carrying: bool,
    /// What was held last went away with its gripper.
    pub gripper_gone: bool,
    /// Ticks for which Prim has reported not-detected.
    pub undetected: u32,
    /// Gripper button of the joystick box in the tick before: pressing counts, not holding down.
    pub button: JoystickGrip,
    /// Last record number given to a changing pose.
    pub last_pose: u32,
}
