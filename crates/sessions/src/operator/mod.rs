//! Connection of an operator to a run (IV): lines of text over a Unix socket.
//!
//! ```text
//!  console ── Client ──socket── session thread ──bounded queue── run, between two ticks
//!                     ◄──────────── answer, without waiting ────────────┘
//! ```
//!
//! * [`protocol`]: the lines of a session, without I/O;
//! * [`clock`]: the time limit of a request, by the clock of the run;
//! * [`Listener`]: the run's side, with one thread per session; its [`Entrance`] admits operators from a network;
//! * [`Client`]: the side of a console or a script.
//!
//! The run defines the meaning of the lines.

mod client;
pub mod clock;
mod listener;
pub mod protocol;

pub use client::{ALIVE, Client, ClientError};
pub use listener::{Entrance, Given, Listener};
pub use protocol::{Answer, Event, Late, Name};
