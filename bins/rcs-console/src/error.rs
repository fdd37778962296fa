//! Errors of the console.

use std::{io, path::PathBuf};

use executive::memory::SharedMemoryError;

#[derive(Debug, thiserror::Error)]
pub enum ConsoleError {
    /// The run does not exist, or cannot be read.
    #[error(transparent)]
    SharedMemory(#[from] SharedMemoryError),
    #[error(transparent)]
    Operator(#[from] sessions::operator::ClientError),
    #[error("a log cannot be operated: leave --operate out, or name a run")]
    OperateLog,
    #[error("{}", .source.of(.path))]
    Log { path: PathBuf, source: record::ReadError },
    /// The log has no ticks.
    #[error("{}: the log holds no tick: nothing can be shown", .0.display())]
    Empty(PathBuf),
    /// The log does not contain the tick.
    #[error("tick {tick} is not there; there are ticks {first} to {last}")]
    NoTick {
        /// The requested tick.
        tick: u64,
        /// First tick of the log.
        first: u64,
        /// Last tick of the log.
        last: u64,
    },
    /// `--once` needs a run or a log.
    #[error("--once needs a run or a log: --run NAME or --log FILE")]
    NothingNamed,
    /// The run has not published a tick yet.
    #[error("the run {0} has published no tick yet: try again")]
    NoPicture(String),
    #[error(
        "the terminal cannot be used: {0}; standard input and output must be a terminal, or use --once SCREEN"
    )]
    Terminal(#[source] io::Error),
    #[error("the signal handler cannot be installed: {0}")]
    Signals(#[source] io::Error),
    #[error("the answer cannot be written: {0}")]
    Output(#[source] io::Error),
}
