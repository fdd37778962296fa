//! The state of a Modbus coupler whose outputs have safe values, without sockets, threads and clock.
//!
//! ```text
//!   Orders, once per tick ──► Session ──► Report: state, inputs, acknowledged outputs
//!                              │   ▲
//!                     requests ▼   │ answers
//!                    Link: TCP, or a Simulated coupler
//! ```
//!
//! The owner calls [`Session::exchange`] at fixed times, twice per tick. A session sends one request at a time and
//! repeats none: the next exchange carries the newest outputs.
//!
//! * [`kind`]: kinds of couplers and their abilities;
//! * [`plan`]: registers, safe values and time limits of a device;
//! * [`report`]: orders to a session, and its state;
//! * [`link`]: the connection that a session needs, and its faults;
//! * [`mod@session`]: the contract: when outputs are safe, when inputs are valid, when a person must release a device;
//! * [`emulated`]: a coupler with process data and a watchdog; [`simulated`]: one with its connection, in simulated
//!   time.
//!
//! Times are ns of one monotonic clock.

#![forbid(unsafe_code)]

pub mod emulated;
pub mod kind;
pub mod link;
pub mod plan;
pub mod report;
pub mod session;
pub mod simulated;

pub use self::{
    emulated::Emulated,
    kind::{Fallback, Kind},
    link::{Fault, Link},
    plan::{Area, InWords, MOST_IN, MOST_OUT, OutWords, Plan, PlanError, Span},
    report::{Mode, Orders, Refusal, Report, State, Trip},
    session::Session,
    simulated::Simulated,
};

/// Nanoseconds in a millisecond.
pub const MS: u64 = 1_000_000;
