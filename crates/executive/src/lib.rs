//! Runs the levels: clocks, boards, common memory, real-time set-up.
//!
//! The control processes are pure state machines; [`closed_loop::course`] steps them with tick-parity buffers, and this
//! crate runs a course. [`runner`] times the steps and publishes the buffers, [`clock`] determines
//! when each tick begins, [`realtime`] requests real-time priority from the system, [`timing`] measures the parts of a
//! tick, [`overrun`] reacts to skipped slots, [`alloc`] counts allocations, [`boards`] distributes the processes over
//! operating system processes, [`memory`] publishes the buffers in shared memory, and [`status`] summarises them.
//! Lines to robots at ports are [`serial`], to a T3, and [`mod@egm`], to a robot with ABB's Externally Guided Motion;
//! [`field`] has the devices behind Modbus couplers.

#![deny(unsafe_code)]

pub mod boards;
pub mod clock;
pub mod egm;
pub mod field;
pub mod histogram;
pub mod machine;
pub mod memory;
pub mod overrun;
pub mod realtime;
pub mod runner;
pub mod serial;
pub mod status;
pub mod timing;

pub use os_io::alloc;
