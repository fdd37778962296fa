//! The AMRF Data System (IV.4.2, IX.2): where each item is.
//!
//! Task knows a command record and a status record. Between them and the data base stand a mailbox each way:
//!
//! ```text
//!   DataBaseCommand --command::encode--> 28 or 240 bytes --Server--> command::decode, statement::parse --> SQLite
//!   DataBaseStatus  <--status::decode--     14 bytes     <--Server--  what became of it
//! ```
//!
//! [`DataSystem`] is the controller's end: with the server on a thread of its own, or in another process
//! ([`Agent`]), where updates wait on the controller's disk until they are answered ([`Outbox`]). The server
//! takes bytes and gives bytes, and is strict: about the bytes, about the statement, and about the order of
//! a connection.

mod agent;
pub mod command;
mod connection;
mod outbox;
mod server;
pub mod statement;
pub mod status;
mod store;

pub use agent::{Agent, Remark};
pub use connection::{ANSWER_TICKS, DataSystem, Pace};
pub use outbox::{Outbox, OutboxError};
pub use server::{Answer, Server};
pub use store::{Item, Said, Store, StoreError, Visit};
