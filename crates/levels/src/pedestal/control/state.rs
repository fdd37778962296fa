//! What the pedestal process remembers from tick to tick.

use rcs_core::{Plain, handshake::Commander, interface::pedestal::PedestalCommand, tick::Tick};

use crate::old_execution::Execution;

/// Everything that the pedestal process remembers.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The current command number, its outcome and its step.
    pub execution: Execution,
    /// The current command: a copy, because the buffer of a commander that restarts is empty.
    pub command: PedestalCommand,
    /// `cycle-cnt` of the command that is echoed, executed or not.
    pub cycle: Tick,
    /// Numbers of the commands to the hand.
    pub hand: Commander,
    /// Numbers of the commands to the table.
    pub table: Commander,
    /// `grasp-size` of the object that the hand holds, 0.01 in; 0 if it holds none.
    pub held_size: i32,
}
