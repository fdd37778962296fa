//! The words that all parts of the RCS-II/T3 controller speak (NBSIR 88-3692).
//!
//! This crate holds no behaviour of a control process and no I/O. It defines what a tick, a name, a pose, a
//! movetable and an interface buffer *are*, so that the levels, the cell, the link, the recorder and the
//! tests agree to the bit:
//!
//! * [`tick`], [`name`], [`units`]: time, names and the manual's integers;
//! * [`frame`], [`pose`], [`movetable`], [`kinematics`]: geometry, in inches and radians;
//! * [`plain`]: one definition of a buffer gives its structure, its byte image and its description;
//! * [`interface`]: the buffers of chapters V and VI;
//! * [`handshake`]: command numbers, echoes and time stamps between two processes;
//! * [`table`]: decision tables, exhaustive by compilation;
//! * [`process`]: the trait of a control process, and tick-parity buffers;
//! * [`digest`]: the fingerprint of a run.
//!
//! Nothing here allocates, panics on input, or depends on the platform's mathematics library.

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
pub use rcs_macros::{Actions, Plain, Variables, commands, decision_table};

pub mod digest;
pub mod frame;
pub mod handshake;
pub mod interface;
pub mod kinematics;
pub mod movetable;
pub mod name;
pub mod plain;
pub mod pose;
pub mod process;
pub mod table;
pub mod tick;
pub mod units;
