//! The AMRF Data System (IV.4.2, IX.2), which stores the position of each item.
//!
//! Task writes a command record and reads a status record:
//!
//! ```text
//!   DataBaseCommand --command::encode--> 28 or 240 bytes --Server--> command::decode, statement::parse --> Records
//!   DataBaseStatus  <--status::decode--     14 bytes     <--Server--  result
//! ```
//!
//! [`DataSystem`] is the controller's end, with a [`ItemStore`] that executes commands. The server accepts only valid
//! bytes, a valid statement, and the steps of a connection in order. Items are kept in memory ([`Books`]), or in the
//! database of the crate `sessions`, which also has keepers on a thread and in another process.

mod books;
pub mod command;
mod connection;
mod records;
mod server;
pub mod statement;
pub mod status;

pub use books::Books;
pub use connection::{ANSWER_TICKS, DataSystem, InMemory, ItemStore, Reply};
pub use records::{Item, LastStatement, Records};
pub use server::{Answer, Server};
