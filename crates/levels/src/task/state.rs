//! What Task remembers from tick to tick.

use rcs_core::{handshake::Commander, record};

use super::plan::Plan;
use crate::execution::Execution;

record! {
    /// State of Task.
    pub struct State {
        /// The command of the HWSC and how far it has come.
        pub execution: Execution,
        /// Commands to Subtask.
        pub subtask: Commander,
        /// The command with its names looked up.
        pub plan: Plan,
        /// Last record number given to a T-POSE.
        pub last_pose: u32,
    }
}
