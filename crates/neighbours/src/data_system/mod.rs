//! The AMRF Data System (IV.4.2, IX.2): who has which item where.
//!
//! Task knows a command record and a status record. Between them and the data base stand a mailbox each way:
//!
//! ```text
//!   DataBaseCommand --command::encode--> 28 or 240 bytes --Server--> command::decode, statement::parse --> SQLite
//!   DataBaseStatus  <--status::decode--     14 bytes     <--Server--  what became of it
//! ```
//!
//! [`DataSystem`] is both ends for a run in one process. The server takes bytes and gives bytes, and is strict: about the
//! bytes, about the statement, and about the order of a connection.

pub mod command;
mod connection;
mod server;
pub mod statement;
pub mod status;
mod store;

pub use connection::{ANSWER_TICKS, DataSystem, Pace};
pub use server::Server;
pub use store::{Item, Store, StoreError};
