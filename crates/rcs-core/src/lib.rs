//! The framework of the RCS-II/T3 controller (NBSIR 88-3692).
//!
//! This crate does no I/O and is independent of robot and cell. It has:
//!
//! * [`tick`], [`name`]: time and names;
//! * [`plain`]: one definition of a record gives its structure, byte image and schema;
//! * [`reflect`]: the fields of a byte image by path, with their values as text;
//! * [`header`], [`handshake`]: the head of output buffers; command numbers, echoes and time stamps of two processes;
//! * [`table`]: decision tables, exhaustive by compilation;
//! * [`digest`]: the digest of a run.
//!
//! No function allocates, panics on input, or depends on the platform's mathematics library.

#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]
#![warn(missing_docs)]
#![cfg_attr(
    not(test),
    deny(
        clippy::as_conversions,
        clippy::arithmetic_side_effects,
        clippy::indexing_slicing,
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic
    )
)]

extern crate self as rcs_core;

pub use plain::Plain;
pub use rcs_macros::{Actions, Plain, Variables, commands, decision_table, state_variables};

pub mod digest;
pub mod handshake;
pub mod header;
pub mod name;
pub mod plain;
pub mod reflect;
pub mod table;
pub mod tick;
