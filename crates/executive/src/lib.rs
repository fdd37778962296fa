//! Runs the levels: clocks, boards, common memory, real-time set-up.
//!
//! [`closed_loop::course`] steps the control processes with tick-parity buffers, and this crate runs a course.
//! [`runner`] times the steps and publishes the buffers, [`clock`] and [`overrun`] determine when ticks begin,
//! [`realtime`] requests real-time priority, [`boards`] distributes the processes over operating system processes,
//! [`memory`] publishes the buffers in shared memory. [`serial`] is the line to a T3, and
//! [`mod@egm`] the line to a robot with EGM. [`field`] has the devices behind Modbus couplers.

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
