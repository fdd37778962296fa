//! The live view: the messages of a log, sent over WebSocket to browsers, Foxglove and Lichtblick.
//!
//! ```text
//!  tick ──ring──> writer of the log ──Tap──> Feed ──bounded queue──> client's thread ──> viewer
//! ```
//!
//! * [`protocol`]: the messages of both subprotocols, to and from bytes;
//! * [`commands`]: requests of a client to the run;
//! * [`session`]: the session of one client, without I/O;
//! * [`feed`]: channels, the newest message of each, and a queue per client;
//! * `http`: the first request of a connection, and the page for browsers;
//! * [`person`]: a person on the network, for whom the gateway connects;
//! * [`server`]: listens on this machine, with one thread per client.
//!
//! The run never waits for a client. A full queue drops its oldest messages and counts them. A client that does not
//! read for five seconds is disconnected with the reason. A client that reads slowly stays connected.

#![cfg_attr(
    not(test),
    deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)
)]

mod client;
pub mod commands;
mod connection;
pub mod feed;
mod frames;
mod http;
pub mod options;
pub mod origin;
mod outgoing;
pub mod person;
pub mod protocol;
pub mod server;
pub mod session;
mod silence;

pub use feed::Feed;
pub use options::Options;
pub use origin::Origin;
pub use protocol::NoRandom;
pub use server::{Port, Server};
