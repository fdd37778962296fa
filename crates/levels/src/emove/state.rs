//! The state of E-move.

use interfaces::{emove::Beliefs, prim::JoystickGrip};
use rcs_core::{Plain, handshake::Commander};

use super::{
    back::Back,
    gripper::Gripper,
    grippers::Grippers,
    rejoin::Rejoin,
    route::Route,
    surroundings::Surroundings,
    tables::{Ordered, Step},
};
use crate::execution::Execution;

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
    /// The part of an interrupted way that is flown back first.
    pub back: Option<Back>,
    /// The points to which the robot goes first, back to its place or path.
    pub rejoin: Option<Rejoin>,
    /// Beliefs about the world: an output, adopted again after a restart.
    pub beliefs: Beliefs,
    /// The beliefs of the time before the start have been adopted.
    pub started: bool,
    /// The robot has been moved away from its place.
    pub away: bool,
    /// How many location points have been looked at to find out where the robot is.
    pub searched: u32,
    /// The known places around a robot that is at none.
    pub surroundings: Surroundings,
    /// The gripper on the robot in the tick before.
    pub attached: Gripper,
    /// The last order to the fingers was to release the held object.
    pub releasing: bool,
    /// Ticks in which neither finger has felt what is held.
    pub unfelt: u8,
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
    /// The last `.R` that has been done.
    pub robot_init: u32,
}
