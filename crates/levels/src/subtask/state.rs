//! What Subtask remembers from tick to tick.

use rcs_core::{handshake::Commander, record};

use crate::execution::Execution;

record! {
    /// State of Subtask.
    pub struct State {
        /// The command of Task and how far it has come.
        pub execution: Execution,
        /// Commands to E-move.
        pub emove: Commander,
    }
}
