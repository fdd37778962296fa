//! The Active Pedestal (VI.7, IX.3) as a separate system: the data of its mailboxes, and its end of them.
//!
//! ```text
//!   PedestalCommand --CommandLayout--> Pedestal from RCS Command --> System: pedestal, hand and table process
//!   OutsidePedestal <--StatusLayout--- Pedestal to RCS Status            <-- the status of VI.7.2
//!                   <--GripperLayout-- Pedestal Gripper to RCS Status    <-- the hand, for Diagnostics
//!                   <--TableLayout---- Pedestal Table to RCS Status      <-- the rotary table, for Diagnostics
//! ```
//!
//! [`System`] is the pedestal's end: the same three processes that the controller steps itself if the pedestal is in
//! its process. The crate `sessions` has the controller's end (`pedestal::Agent`), whose data are an input of the next
//! tick ([`interfaces::OutsidePedestal`]): boards, logs and replays do not depend on the network.
//!
//! Two more mailboxes carry the words of the pedestal's devices in the simulated cell ([`cell`]). All integers have
//! four bytes, `cycle-cnt` eight, as in the controller (CHOSEN). So a run does not depend on the process in which its
//! pedestal runs.

pub mod cell;
pub mod command;
pub mod gripper;
pub mod status;
mod system;
pub mod table;
#[cfg(test)]
mod tests;

pub use system::System;

use interfaces::{Decided, Header};

use crate::layout::LayoutError;

const WORD: usize = 10; // characters of a command or status
const STEP: usize = 16;

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PedestalError {
    #[error("executing, done, can't-do or error was expected for the command {0}, found idle")]
    Idle(u32), // exactly one of number and status means "no command"
    #[error(transparent)]
    Layout(#[from] LayoutError),
}

/// 0 means none.
fn table(header: &Header) -> u8 {
    header.decided.map_or(0, |decided| decided.table)
}

fn set_table(header: &mut Header, table: u8) {
    header.decided = (table != 0).then_some(Decided { table, row: 0 });
}

/// 0 means none.
fn row(header: &Header) -> u8 {
    header.decided.map_or(0, |decided| decided.row)
}

fn set_row(header: &mut Header, row: u8) {
    if let Some(decided) = &mut header.decided {
        decided.row = row;
    }
}
