//! What Task remembers from tick to tick.

use rcs_core::{coded_enum, handshake::Commander, interface::DataBaseCommand, record};

use super::plan::Plan;
use crate::execution::Execution;

coded_enum! {
    /// Who has the robot.
    pub enum Watch {
        /// The commands.
        Free = "free",
        /// The operator, with the joystick box.
        Manual = "manual",
    }
}

record! {
    /// What Task knows of the Data System.
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
}

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
        /// Who has the robot.
        pub watch: Watch,
        /// The Data System.
        pub ledger: Ledger,
    }
}
