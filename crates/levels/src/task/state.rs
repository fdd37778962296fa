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
    /// The command of the HWSC and its progress.
    pub execution: Execution,
    /// Step of its table.
    pub step: Step,
    /// The recipient of the last order.
    pub ordered: TaskRecipient,
    /// What has the robot.
    pub control: Control,
    /// The command with its names looked up.
    pub plan: Plan,
    /// Last record number given to a T-POSE.
    pub last_pose: u32,
    /// The support of the held object that a person has confirmed.
    pub confirmed: Option<Confirmed>,
    /// Commands to Subtask.
    pub subtask: Commander,
    /// Commands to the Data System.
    pub data_system: DataSystem,
}
