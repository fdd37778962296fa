//! Modbus TCP: requests and answers of client and server, as bytes.
//!
//! This crate does no I/O, reads no clock and does not allocate. The owner of a connection reads bytes until
//! [`mbap::needed`] has all of a frame, and passes the frame on:
//!
//! ```text
//!   Client::request(&Request) ──► frame ──► server::answer(frame, &mut impl Tables)
//!   Client::answer            ◄── frame ◄──
//! ```
//!
//! * [`mbap`]: the header of a frame, and the length of a frame in a stream;
//! * [`request`]: the nine requests: functions 1 to 6, 15, 16 and 23;
//! * [`client`]: writes requests, and accepts an answer only if it belongs to the request;
//! * [`server`]: answers requests from the four tables of a [`Tables`];
//! * [`values`]: registers and bits, in frames and in memory;
//! * [`exception`]: why a server refuses a request; [`error`]: why a frame is refused.
//!
//! Section numbers are those of *MODBUS Application Protocol Specification V1.1b3* ("AP 6.3") and of *MODBUS Messaging
//! on TCP/IP Implementation Guide V1.0b* ("MG 3.1.3"). Addresses are those in the frames: the first one is 0.

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

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

mod bytes;
pub mod client;
pub mod error;
pub mod exception;
pub mod mbap;
pub mod request;
pub mod server;
pub mod values;

pub use self::{
    client::{Client, Response},
    error::Error,
    exception::Exception,
    mbap::{Header, MOST_FRAME_BYTES},
    request::Request,
    server::Tables,
    values::{Bits, Words},
};
