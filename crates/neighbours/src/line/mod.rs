//! The line between the controller and a neighbour, as bytes: docs/neighbours.md "On the line".
//!
//! * [`role`]: the neighbours and the mailboxes of each; [`clock`]: the clock of the run;
//! * [`address`]: the addresses of controllers;
//! * [`frame`]: a mailgram on the line, and the pulse for each tick;
//! * [`session`]: the protocol of both sides, without sockets and clocks.
//!
//! The crate `sessions` moves these bytes through sockets, and `rcs-gateway` between machines.

pub mod address;
pub mod clock;
pub mod frame;
pub mod role;
pub mod session;

pub use address::Address;
pub use clock::ClockKind;
pub use role::Role;
pub use session::Session;
