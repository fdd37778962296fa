//! The record of a run: an MCAP file that shows the moving cell in any viewer and is a test at the same time.
//!
//! ```text
//!  tick ──copy──> ring ──> writer thread ──> file.mcap ──> viewers
//!                                               │
//!                              difference <── replay ──> Ladder
//! ```
//!
//! * [`recorder`]: what the run calls. Nothing there allocates or waits in a real-time run.
//! * [`writer`]: what a log holds, and how it gets into the file.
//! * [`reader`]: reads a log back, also one whose program was killed.
//! * [`mod@replay`]: runs the control processes on the recorded inputs and compares every output buffer of every
//!   tick, bit for bit.
//! * [`views`], [`ladder`], [`instruments`], [`rows`]: the state of the run for viewers.
//! * [`explanation`]: tables and reasons, so that a log explains itself.
//! * [`layout`], [`delta`]: byte images, and what changed in them.
//! * [`proto`]: the messages of the channels.
//!
//! The log of a run in fast clock has no wall-clock time in it: the same run writes the same file, to the
//! byte.

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
