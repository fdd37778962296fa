//! What E-move remembers from tick to tick.

use rcs_core::{Plain, handshake::Commander, interface::prim::JoystickGrip, name::Name16, pose::Pose};
use taskdata::files::EndEffId;

use super::{
    gripper::{Gripper, Grippers},
    robot_place::RobotPlace,
    route::Route,
    tables::{Ordered, Step},
};
use crate::execution::Execution;

/// What the gripper holds.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Held {
    /// The object.
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
    /// The object.
    pub object: Name16,
    /// Record of LOCPT where it is; a static array has none.
    pub record: Option<u32>,
    /// Record of ARRAY-TABLE where it is, if it lies in a sector.
    pub array: Option<u32>,
    /// Its part frame.
    pub pose: Pose,
}

/// State of E-move.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The command of Subtask and how far it has come.
    pub execution: Execution,
    /// Step of its table.
    pub step: Step,
    /// The process that has its last order.
    pub ordered: Ordered,
    /// It has ordered something of Prim, or waits until Prim has ended what it did before.
    pub uses_prim: bool,
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
    /// The way to the goal of the current command, if it is a motion command.
    pub route: Option<Route>,
    /// Where the robot is, if that is known.
    pub place: Option<RobotPlace>,
    /// How many location points have been looked at to find out where the robot is.
    pub searched: u32,
    /// What the gripper holds.
    pub held: Option<Held>,
    /// What vision has located.
    pub located: Option<Located>,
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
