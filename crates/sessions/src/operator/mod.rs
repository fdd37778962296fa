//! Connection of an operator to a run (IV): lines of text over a Unix socket.
//!
//! ```text
//!  console ── Client ──socket── session thread ──bounded queue── run, between two ticks
//!                     ◄──────────── answer, without waiting ────────────┘
//! ```
//!
//! The run determines the meaning of the lines.

mod client;
pub mod clock;
mod listener;
pub mod protocol;

pub use client::{ALIVE, Client, ClientError};
pub use listener::{Entrance, Given, Listener};
pub use protocol::{Answer, Event, Late, Name};
