use interfaces::hws::Confirmed;
use rcs_core::{Plain, handshake::Commander};

use super::{
    data_system::DataSystem,
    plan::Plan,
    tables::{Step, TaskRecipient, joystick::Control},
};
use crate::execution::Execution;

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    pub execution: Execution,
    pub step: Step,
    pub ordered: TaskRecipient,
    pub control: Control, // the owner of the robot
    pub plan: Plan,
    pub last_pose: u32,               // record number given last to a T-POSE
    pub confirmed: Option<Confirmed>, // the support of the held object, confirmed by a person
    pub subtask: Commander,
    pub data_system: DataSystem,
}
