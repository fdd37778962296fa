use interfaces::pedestal::PedestalCommand;
use rcs_core::{Plain, handshake::Commander, tick::Tick};

use super::tables::{PedestalRecipient, Step};
use crate::execution::Execution;

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    pub execution: Execution,
    pub step: Step,
    pub command: PedestalCommand, // a copy: the buffer of a restarted commander is empty
    pub cycle: Tick,              // `cycle-cnt` of the echoed command, executed or not
    pub ordered: PedestalRecipient,
    pub hand: Commander,
    pub table: Commander,
    pub gripped: bool, // GRIP was ordered, and no opening afterwards
}
