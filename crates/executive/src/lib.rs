//! Runs the levels: clocks, boards, common memory, real-time set-up.
//!
//! The control processes are pure state machines; this crate gives them time and surroundings. [`course`]
//! steps them with tick-parity buffers and sums up what they did, [`runner`] times that and publishes it, [`clock`] says when, [`realtime`] asks the
//! system for punctuality, [`timing`] says where the time goes and [`overrun`] what is done if there is too little
//! of it, [`serial`] is the line to a real robot, [`alloc`] proves that nothing is allocated
//! on the way, [`boards`] spreads the processes over operating system processes, [`memory`] lets others look on,
//! [`status`] sums up what they see, [`generations`] lets task data be loaded between commands, and
//! [`failure`] finds the process, the table and the row that explain why something went wrong.

#![deny(unsafe_code)]

pub mod boards;
pub mod clock;
pub mod course;
pub mod failure;
pub mod generations;
pub mod histogram;
pub mod machine;
pub mod memory;
pub mod overrun;
pub mod realtime;
pub mod rest;
pub mod runner;
pub mod serial;
pub mod status;
pub mod timing;

pub use counting_alloc as alloc;
