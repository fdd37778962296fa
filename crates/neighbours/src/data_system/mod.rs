//! The AMRF Data System (IV.4.2, IX.2), which stores the position of each item.
//!
//! Task writes a command record and reads a status record. Two mailboxes connect them with the data base:
//!
//! ```text
//!   DataBaseCommand --command::encode--> 28 or 240 bytes --Server--> command::decode, statement::parse --> SQLite
//!   DataBaseStatus  <--status::decode--     14 bytes     <--Server--  result
//! ```
//!
//! [`DataSystem`] is the controller's end. The server runs in memory, on a separate thread, or in another process
//! ([`Agent`]); then updates wait on the controller's disk until they are answered ([`Outbox`]). The server
//! takes the bytes of a command and returns those of a status. It accepts only valid bytes, a valid statement,
//! and the steps of a connection in their order.

mod agent;
mod alone;
mod books;
pub mod command;
mod connection;
mod outbox;
mod server;
pub mod statement;
pub mod status;
mod store;
mod thread;

pub use agent::{Agent, Remark};
pub use books::Books;
pub use connection::{ANSWER_TICKS, DataSystem, InMemory, Keeper, Reply};
pub use outbox::{Outbox, OutboxError};
pub use server::{Answer, Records, Server};
pub use store::{Item, Said, Store, StoreError, Visit};
pub use thread::{Pace, Threaded};
