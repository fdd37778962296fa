//! The record of a run: an MCAP file that shows the moving cell in any viewer and is also a test.
//!
//! ```text
//!  tick ──copy──> ring ──> writer thread ──> file.mcap ──> viewers
//!                                               │
//!                              difference <── replay ──> Ladder
//! ```
//!
//! * [`recorder`]: the interface for the run. It neither allocates nor waits in a real-time run.
//! * [`writer`]: the content of a log, and its path into the file.
//! * [`reader`]: reads a log, also that of a killed program.
//! * [`journal`]: what a controller knows, for a start after a loss of power.
//! * [`mod@replay`]: runs the control processes on the recorded inputs and compares every output buffer of every
//!   tick, bit for bit.
//! * [`views`], [`ladder`], [`instruments`], [`rows`]: the state of the run for viewers.
//! * [`explanation`], [`tables`]: tables and reasons, with which a log explains itself.
//! * [`layout`], [`delta`]: byte images and their differences.
//! * [`proto`]: the messages of the channels.
//!
//! The log of a run in fast clock contains no wall-clock time: the same run writes the same bytes.

#![forbid(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)
)]

pub mod channels;
mod comparison;
pub mod contacts;
pub mod delta;
mod described;
mod drain;
pub mod error;
pub mod explanation;
pub mod file;
pub mod golden;
pub mod input;
pub mod instruments;
pub mod journal;
pub mod ladder;
pub mod layout;
pub mod lossless;
pub mod names;
mod operator;
mod part;
mod pieces;
pub mod proto;
pub mod reader;
pub mod recorder;
pub mod remarks;
pub mod replay;
mod rotation;
pub mod rows;
pub mod scene;
pub mod sink;
pub mod tables;
pub mod tap;
pub mod trail;
pub mod views;
pub mod writer;

pub use error::{ReadError, RecordError, ReplayError};
pub use file::LogFile;
pub use input::{Attachment, CellFrame, CellModel, End, Epoch, Lost, Model, Name, Setup, Shown, Touch};
pub use operator::{OPERATOR, OperatorLine};
pub use part::{Before, Part};
pub use proto::foxglove::{Level, Link, Transform};
pub use reader::Log;
pub use recorder::{Pace, Recorder, Summary};
pub use replay::{Difference, Options, ReplayReport, replay, replay_with};
pub use rotation::LogLimit;
pub use tap::Tap;
pub use writer::Timing;
