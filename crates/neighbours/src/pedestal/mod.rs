//! The Active Pedestal (VI.7, IX.3) as a system of its own: what stands in its mailboxes, and both ends of them.
//!
//! ```text
//!   PedestalCommand --command::encode--> Pedestal from RCS Command --> Station: pedestal, hand and table process
//!   OutsidePedestal <--status::decode--- Pedestal to RCS Status            <-- the status of VI.7.2
//!                   <--gripper::decode-- Pedestal Gripper to RCS Status    <-- the hand, for Diagnostics
//!                   <--table::decode---- Pedestal Table to RCS Status      <-- the rotary table, for Diagnostics
//! ```
//!
//! [`Agent`] is the controller's end, [`Station`] the pedestal's: the same three processes that the controller steps itself if the
//! pedestal is in its own process. What the agent gets is an input of the next tick
//! ([`rcs_core::interface::OutsidePedestal`]), so that boards, logs and replays need to know nothing of the network.
//!
//! A pedestal of the simulated cell has its devices there: their words travel in two mailboxes more ([`cell`]). A real one has
//! devices of its own.
//!
//! All integers have four bytes, `cycle-cnt` eight, as in the controller (CHOSEN: the manual gives no widths): so whatever can be
//! commanded can be said, and a run is the same to the bit wherever its pedestal is.

mod agent;
pub mod cell;
pub mod command;
pub mod gripper;
mod station;
pub mod status;
pub mod table;
#[cfg(test)]
mod tests;

pub use agent::{Agent, Remark};
pub use station::Station;

use rcs_core::{
    interface::{Decided, Header, Reason, grip::Felt},
    name::{Name, Name16},
};

use crate::fields::{FieldError, Packer, Unpacker};

/// Characters of a command or a status.
const WORD: usize = 10;
/// Characters of a step.
const STEP: usize = 16;

/// Why data cannot be what stands in a mailbox of the pedestal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LayoutError {
    /// Another number of bytes.
    #[error("{what} of {expected} bytes was expected, found {found}")]
    Size {
        /// What was expected.
        what: &'static str,
        /// Its bytes.
        expected: usize,
        /// Bytes found.
        found: usize,
    },
    /// Somebody has a command and none.
    #[error("executing, done, can't-do or error was expected for the command {0}, found idle")]
    Idle(u32),
    /// A field that cannot be.
    #[error(transparent)]
    Field(#[from] FieldError),
}

/// Fields of data that must be so many bytes.
fn fields<'a>(what: &'static str, expected: usize, data: &'a [u8]) -> Result<Unpacker<'a>, LayoutError> {
    if data.len() == expected {
        Ok(Unpacker::new(data))
    } else {
        Err(LayoutError::Size { what, expected, found: data.len() })
    }
}

/// One of the words of a field of `W` characters.
fn word<const W: usize, T>(
    fields: &mut Unpacker<'_>,
    field: &'static str,
    from_text: impl Fn(&str) -> Option<T>,
) -> Result<T, FieldError> {
    let found: Name<W> = fields.name(field)?;
    from_text(found.as_str())
        .ok_or_else(|| FieldError::Word { field, found: Name16::clipped(found.as_str()) })
}

/// Why something failed: the code of a [`Reason`] in four bytes, 0 for none.
fn reason(fields: &mut Unpacker<'_>, field: &'static str) -> Result<Reason, FieldError> {
    let found = fields.long(field)?;
    let code = u8::try_from(found).ok().and_then(Reason::from_code);
    code.ok_or_else(|| FieldError::Code { field, found: u16::try_from(found).unwrap_or(u16::MAX) })
}

/// What a gripper feels, by its code.
fn felt(fields: &mut Unpacker<'_>) -> Result<Felt, FieldError> {
    let found = fields.byte("felt")?;
    Felt::from_code(found).ok_or(FieldError::Code { field: "felt", found: found.into() })
}

/// Decision table and row of a process, two bytes each, and the step of its command after that row.
fn put_row<const N: usize>(fields: &mut Packer<N>, header: &Header) {
    let (table, row) = header.decided.map_or((0, 0), |Decided { table, row }| (table, row));
    fields.word(table.into());
    fields.word(row.into());
    fields.text(STEP, &header.step.unwrap_or_default());
}

/// The header of a process, without a stamp.
fn take_row(fields: &mut Unpacker<'_>) -> Result<Header, FieldError> {
    let (table, row) = (fields.byte("table#")?, fields.byte("row#")?);
    let decided = Some(Decided { table, row }).filter(|_| table != 0);
    let step = Some(fields.name::<STEP>("step")?).filter(|step| !step.is_empty());
    Ok(Header { decided, step, ..Header::default() })
}
