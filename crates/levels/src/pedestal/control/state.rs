use interfaces::pedestal::PedestalCommand;
use rcs_core::{Plain, handshake::Commander, tick::Tick};

use super::tables::{PedestalRecipient, Step};
use crate::execution::Execution;

/// State of the pedestal process.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The command of Subtask and its progress.
    pub execution: Execution,
    /// Step of its table.
    pub step: Step,
    /// The current command: a copy, because the buffer of a commander that restarts is empty.
    pub command: PedestalCommand,
    /// `cycle-cnt` of the echoed command, executed or not.
    pub cycle: Tick,
    /// Who has its orders.
    pub ordered: PedestalRecipient,
    /// Commands to the hand.
    pub hand: Commander,
    /// Commands to the table.
    pub table: Commander,
    /// GRIP was ordered, and no opening afterwards.
    pub gripped: bool,
}
