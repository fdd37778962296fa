//! Why a log cannot be forked.

use std::io;

use record::{ReadError, ReplayError};
use runtime::{ChangeError, RepeatError, StartError};

use super::change::Refusal;

/// Why a log cannot be forked.
#[derive(Debug, thiserror::Error)]
pub enum ForkError {
    /// The log does not hold the whole run.
    #[error(transparent)]
    Repeat(#[from] RepeatError),
    /// Its task data cannot be used.
    #[error(transparent)]
    Data(#[from] ReplayError),
    /// It cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The run cannot begin.
    #[error("{0}")]
    Start(#[from] StartError),
    /// A change is refused.
    #[error(transparent)]
    Refused(#[from] Box<Refusal>),
    /// The run refuses it.
    #[error("the change is refused after tick {tick}: {source}")]
    Change {
        /// The tick.
        tick: u64,
        /// Why.
        source: ChangeError,
    },
    /// The cell is built before the first tick.
    #[error("cell {0} can be changed before the first tick only, when the cell is built: use --tick 0")]
    CellLater(String),
    /// No such tick.
    #[error("there is nothing to fork after tick {tick}: a tick from 0 to {last} was expected")]
    NoTick {
        /// As asked for.
        tick: u64,
        /// The one before the last.
        last: u64,
    },
    /// Nothing went wrong.
    #[error("nothing went wrong in this run: name a tick with --tick")]
    NoFailure,
    /// The log is to be written over.
    #[error("the fork would overwrite the log that it comes from: name another file")]
    SameFile,
    /// The program has changed, or the log does not have all that the run depended on.
    #[error(
        "this program differs from the log from tick {tick} on: {field} was {was} and is {is}; \
         run the job again with this program, and fork that log"
    )]
    Differs {
        /// The tick.
        tick: u64,
        /// Field of a buffer, or what the cell is like.
        field: String,
        /// As recorded.
        was: String,
        /// As computed.
        is: String,
    },
    /// The run has ended before.
    #[error("this program ends the run at tick {0}, where the log goes on")]
    Over(u64),
    /// Files of the log cannot be kept meanwhile.
    #[error("the files of the log cannot be unpacked: {0}")]
    Scratch(#[from] io::Error),
}
