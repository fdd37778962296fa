//! What Task remembers from tick to tick.

use rcs_core::{Plain, handshake::Commander, interface::DataBaseCommand};

use super::plan::Plan;
use crate::old_execution::Execution;

/// Who has the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Watch {
    /// The commands.
    Free,
    /// The operator, with the joystick box.
    Manual,
}

/// What Task knows of the Data System.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Ledger {
    /// Numbers of the commands to it.
    pub commander: Commander,
    /// The command that was written last.
    pub request: DataBaseCommand,
    /// How often it was written.
    pub tries: u8,
    /// A STARTUP has succeeded, and no SHUTDOWN came since.
    pub connected: bool,
    /// The last update.
    pub update: DataBaseCommand,
    /// The last update has not been taken yet: it is kept.
    pub owed: bool,
    /// The update of the current command has been written.
    pub told: bool,
}

/// State of Task.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The command of the HWSC and how far it has come.
    pub execution: Execution,
    /// Commands to Subtask.
    pub subtask: Commander,
    /// The command with its names looked up.
    pub plan: Plan,
    /// Last record number given to a T-POSE.
    pub last_pose: u32,
    /// Who has the robot.
    pub watch: Watch,
    /// The Data System.
    pub ledger: Ledger,
}
