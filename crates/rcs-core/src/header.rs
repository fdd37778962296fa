//! The header of output buffers.

use crate::{Plain, name::Name16, tick::Tick};

/// What every set of output buffers starts with.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Header {
    /// Tick that wrote the buffers. A stamp other than the last tick means that the process is lost.
    pub stamp: Tick,
    /// The process was not stepped in that tick (dormant or held); its last outputs were republished for it.
    pub republished: bool,
    /// The row that decided last, if any has.
    pub decided: Option<Decided>,
    /// Step of the current command after that row: its reference action (V.1.1).
    pub step: Option<Name16>,
}

/// A row of a decision table, by number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub struct Decided {
    /// The table, from 1 in the order of the process's tables.
    pub table: u8,
    /// The row, from 1.
    pub row: u8,
}
