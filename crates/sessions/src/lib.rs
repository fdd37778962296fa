//! Connections of a run with other processes.
//!
//! * [`network`]: carries mailboxes to neighbours over a Unix socket;
//! * [`pedestal`], [`vision`]: the controller's end of a neighbour in another process;
//! * [`data_system`]: the database of items, on a thread or in another process;
//! * [`operator`]: lines of text over a Unix socket, from the console of an operator or a script;
//! * [`live`]: the messages of a log over WebSocket, to viewers.
//!
//! A run never waits for an operator or a viewer, and waits for a neighbour only in fast clock.

#![forbid(unsafe_code)]

pub mod data_system;
pub mod live;
pub mod network;
pub mod operator;
pub mod pedestal;
pub mod vision;
