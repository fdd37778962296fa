//! Errors of forking a log.

use std::{io, path::PathBuf};

use record::{ReadError, ReplayError};
use runtime::{ChangeError, RepeatError, StartError};

use super::change::Refusal;

#[derive(Debug, thiserror::Error)]
pub enum ForkError {
    /// The log does not hold the whole run.
    #[error(transparent)]
    Repeat(#[from] RepeatError),
    /// The task data of the log are invalid.
    #[error(transparent)]
    Data(#[from] ReplayError),
    #[error(transparent)]
    Read(#[from] ReadError),
    #[error("{0}")]
    Start(#[from] StartError),
    #[error(transparent)]
    Refused(#[from] Box<Refusal>),
    #[error("the change is refused after tick {tick}: {source}")]
    Change {
        /// The last tick before the change.
        tick: u64,
        source: ChangeError,
    },
    /// A change of the cell after tick 0. The cell is built before the first tick.
    #[error("cell {0} can be changed before the first tick only, when the cell is built: use --tick 0")]
    CellLater(String),
    /// The log has no such tick, or no tick after it.
    #[error("there is nothing to fork after tick {tick}: a tick from 0 to {last} was expected")]
    NoTick {
        /// The requested tick.
        tick: u64,
        /// The last possible tick.
        last: u64,
    },
    /// The run has no failure, which `--at-failure` needs.
    #[error("nothing went wrong in this run: name a tick with --tick")]
    NoFailure,
    /// The output would replace the log of the fork, or a file that is not a log.
    #[error("the fork cannot be written to {path}: {source}")]
    Output { path: PathBuf, source: io::Error },
    /// The program has changed, or the log lacks data that the run depended on.
    #[error(
        "this program differs from the log from tick {tick} on ({field} was {was}, is {is}): fork a log of this program"
    )]
    Differs {
        /// The first tick that differs.
        tick: u64,
        /// Name of a field of a buffer, or of the cell.
        field: String,
        was: String,
        is: String,
    },
    /// The repeated run ends before the log does.
    #[error("this program ends the run at tick {0}, where the log goes on")]
    Over(u64),
    /// The attachments of the log cannot be unpacked.
    #[error("the files of the log cannot be unpacked: {0}")]
    Scratch(#[from] io::Error),
}
