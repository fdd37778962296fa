//! Runs the levels: clocks, boards, common memory, real-time set-up.
//!
//! The control processes are pure state machines; this crate runs them. [`course`] steps them with tick-parity buffers
//! and records digest and first failure, [`runner`] times the steps and publishes the buffers, [`clock`] determines
//! when each tick begins, [`realtime`] requests real-time priority from the system, [`timing`] measures the parts of a
//! tick, [`overrun`] reacts to skipped slots, [`serial`] is the line to a real robot, [`alloc`] counts allocations,
//! [`boards`] distributes the processes over operating system processes, [`memory`] publishes the buffers in shared
//! memory, [`status`] summarises them, and [`failure`] finds process, table and row of a failure.

#![deny(unsafe_code)]

pub mod boards;
pub mod clock;
pub mod course;
pub mod failure;
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
