//! The DEPC link: "Dynamic External Path Control", the serial line over which an external computer controls a
//! Cincinnati Milacron T3 (NBSIR 88-3692, appendix A; version 1.1, 7 Jul 82).
//!
//! Both ends are state machines without I/O or clock. Each is stepped once per tick: it takes the received bytes and
//! returns the bytes to send ([`link::LinkBytes`]):
//!
//! ```text
//!   host (T3 Interface)                         controller (Acramatic)
//!   host::Host          -- 03 data, 18, 05 -->  controller::Controller -- Robot::accept --> servos
//!                       <-- FF FF 03, 06, 15 --
//! ```
//!
//! * [`link`]: the bytes of a tick, faults and counters;
//! * [`plate`]: the six words of a position and their coding;
//! * [`wire`]: the frames, one file each, byte by byte;
//! * [`receive`]: byte-by-byte receivers of both ends;
//! * [`limit`], [`step`]: the velocity limits, and steps that respect them;
//! * [`host`], [`controller`]: the two ends; [`warning`]: the warnings of the controller;
//! * [`track`]: the last positions sent, as a path, and the distance of a robot from it;
//! * [`exact`]: the unrounded frames, for a robot with a finer resolution than 0.01 in;
//! * [`fault`]: faults on the line between the ends, from a plan and a seed.
//!
//! Decisions that the appendix leaves open are marked ASSUMED.

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

pub mod controller;
pub mod error;
pub mod exact;
pub mod fault;
pub mod host;
pub mod limit;
pub mod link;
pub mod plate;
pub mod receive;
pub mod step;
pub mod track;
pub mod warning;
pub mod wire;

pub use error::Error;
pub use limit::Limits;
pub use plate::Plate;
