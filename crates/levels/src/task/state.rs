//! The state of Task.

use interfaces::hws::Confirmed;
use rcs_core::{Plain, handshake::Commander};

use super::{
    data_system::DataSystem,
    plan::Plan,
    tables::{Step, TaskRecipient, joystick::Control},
};
use crate::execution::Execution;

/// State of Task.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The command of the HWSC and how far it has come.
    pub execution: Execution,
    pub step: Step,
    /// The neighbour that has its last order.
    pub ordered: TaskRecipient,
    pub control: Control,
    /// The command with its names looked up.
    pub plan: Plan,
    /// Last record number given to a T-POSE.
    pub last_pose: u32,
    /// What a person has confirmed about what the gripper holds.
    pub confirmed: Option<Confirmed>,
    pub subtask: Commander,
    pub data_system: DataSystem,
}
