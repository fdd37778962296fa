//! The Active Pedestal (VI.7, IX.3) as a separate system: the data of its mailboxes, and its end of them.
//!
//! ```text
//!   PedestalCommand --CommandLayout--> Pedestal from RCS Command --> System: pedestal, hand and table process
//!   OutsidePedestal <--StatusLayout--- Pedestal to RCS Status            <-- the status of VI.7.2
//!                   <--GripperLayout-- Pedestal Gripper to RCS Status    <-- the hand, for Diagnostics
//!                   <--TableLayout---- Pedestal Table to RCS Status      <-- the rotary table, for Diagnostics
//! ```
//!
//! The crate `sessions` has the controller's end (`pedestal::Agent`). [`System`] is the pedestal's end: the same three
//! processes that the controller steps itself if the pedestal is in its process. The agent's data are an input of the
//! next tick ([`interfaces::OutsidePedestal`]), so that boards, logs and replays do not depend on the network.
//!
//! In the simulated cell the pedestal's devices are part of the cell. Two more mailboxes carry their words
//! ([`cell`]). A real pedestal has its own devices.
//!
//! All integers have four bytes, `cycle-cnt` eight, as in the controller (CHOSEN: the manual gives no widths). The
//! mailboxes can therefore hold every command, and a run is bit-identical in whichever process its pedestal runs.

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

/// Characters of a command or a status.
const WORD: usize = 10;
const STEP: usize = 16;

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PedestalError {
    /// Number and status contradict each other: exactly one of them means "no command".
    #[error("executing, done, can't-do or error was expected for the command {0}, found idle")]
    Idle(u32),
    #[error(transparent)]
    Layout(#[from] LayoutError),
}

/// Number of the decision table of a process; 0 for none.
fn table(header: &Header) -> u8 {
    header.decided.map_or(0, |decided| decided.table)
}

fn set_table(header: &mut Header, table: u8) {
    header.decided = (table != 0).then_some(Decided { table, row: 0 });
}

/// Number of the row that fired; 0 for none.
fn row(header: &Header) -> u8 {
    header.decided.map_or(0, |decided| decided.row)
}

fn set_row(header: &mut Header, row: u8) {
    if let Some(decided) = &mut header.decided {
        decided.row = row;
    }
}
