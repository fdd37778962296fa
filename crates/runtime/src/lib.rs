//! A run of the controller as a library.
//!
//! A [`RunConfig`] describes the run: task data, job, clock, robot, faults, boards, neighbours, log. [`Run::new`] reads
//! and checks it and starts the required parts; [`Run::step`] runs one tick; [`Run::finish`] ends the log and returns
//! the [`RunOutcome`]. An [`Observer`] receives messages, each [`Event`] and each tick.
//!
//! ```no_run
//! use runtime::{LogTarget, Run, RunConfig};
//!
//! let config = RunConfig { log: LogTarget::None, ..RunConfig::new("data", "linkbar") };
//! let outcome = Run::new(config, Box::new(()))?.complete();
//! assert!(outcome.is_finished());
//! # Ok::<(), runtime::StartError>(())
//! ```
//!
//! A tick: receive bytes from a serial line, run the controller (with measured time and allocations), send bytes, pass
//! the tick to the log, advance the cell, run the workstation controller. Time and allocations of the cell's physics
//! are not attributed to the controller.

pub mod agreement;
mod as_text;
pub mod boards;
mod cell_view;
pub mod change;
mod commanded;
pub mod config;
mod contradiction;
mod egm;
pub mod error;
pub mod event;
pub mod field;
pub mod findings;
pub mod judge;
mod live;
mod load;
pub mod loads;
mod log;
pub mod neighbours;
mod network;
pub mod observer;
mod operator;
mod outside;
mod own;
mod pace;
pub mod repeat;
pub mod result;
mod resume;
mod robot;
mod run;
pub mod setup;
mod switched;
mod verdict;
mod views;

pub use self::{
    change::ChangeError,
    config::{Boards, ClockKind, FieldConfig, LogTarget, OperatorAccess, RobotConfig, RobotKind, RunConfig},
    error::StartError,
    event::Event,
    observer::{Observer, TickReport},
    own::OwnRobot,
    repeat::RepeatError,
    run::{Run, RunOutcome},
    verdict::Ending,
    views::controller_state,
};

pub const COMMIT: &str = env!("RCS_COMMIT"); // commit of the sources of this build
