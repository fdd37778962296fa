use std::{io, path::PathBuf};

use record::{ReadError, ReplayError};
use runtime::{ChangeError, RepeatError, StartError};

use super::change::Refusal;

#[derive(Debug, thiserror::Error)]
pub enum ForkError {
    #[error(transparent)]
    Repeat(#[from] RepeatError),
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
        tick: u64, // the last tick before the change
        source: ChangeError,
    },
    /// A change of the cell after tick 0. The cell is built before the first tick.
    #[error("cell {0} can be changed before the first tick only, when the cell is built: use --tick 0")]
    CellLater(String),
    /// The log has no such tick, or no tick after it.
    #[error("there is nothing to fork after tick {tick}: a tick from 0 to {last} was expected")]
    NoTick {
        tick: u64, // the requested tick
        last: u64, // the last possible tick
    },
    #[error("nothing went wrong in this run: name a tick with --tick")]
    NoFailure,
    #[error("the fork cannot be written to {path}: {source}")]
    Output { path: PathBuf, source: io::Error },
    /// The program has changed, or the log lacks data that the run depended on.
    #[error(
        "this program differs from the log from tick {tick} on ({field} was {was}, is {is}): fork a log of this program"
    )]
    Differs {
        tick: u64,     // the first tick that differs
        field: String, // name of a field of a buffer, or of the cell
        was: String,
        is: String,
    },
    #[error("this program ends the run at tick {0}, but the log continues")]
    Over(u64),
    #[error("the files of the log cannot be unpacked: {0}")]
    Scratch(#[from] io::Error),
}
