//! The live view: what a log gets, over WebSocket, to Foxglove and Lichtblick.
//!
//! ```text
//!  tick ──ring──> writer of the log ──Tap──> Feed ──bounded queue──> client's thread ──> viewer
//! ```
//!
//! * [`protocol`]: the messages of both subprotocols, to and from bytes;
//! * [`commands`]: what a client may ask of the run;
//! * [`session`]: what one client may ask for and what it gets, without I/O;
//! * [`feed`]: channels, the newest message of each, and a queue a client;
//! * [`server`]: listens on this machine, one thread a client.
//!
//! A client is never waited for. A queue that is full drops its oldest messages and counts them, and a client
//! that takes nothing for five seconds is disconnected.

#![forbid(unsafe_code)]
#![warn(missing_docs)]
#![cfg_attr(
    not(test),
    deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)
)]

mod client;
pub mod commands;
pub mod feed;
mod frames;
pub mod origin;
pub mod protocol;
pub mod server;
pub mod session;

pub use feed::Feed;
pub use origin::Origin;
pub use protocol::NoRandom;
pub use server::{Options, Port, Server};
