//! Errors of the console.

use std::{io, path::PathBuf};

use executive::memory::SharedMemoryError;

/// Errors of the console.
#[derive(Debug, thiserror::Error)]
pub enum ConsoleError {
    /// The run does not exist, or cannot be read.
    #[error(transparent)]
    SharedMemory(#[from] SharedMemoryError),
    /// The run accepts no operator.
    #[error(transparent)]
    Operator(#[from] sessions::operator::ClientError),
    /// A log cannot be operated.
    #[error("a log cannot be operated: leave --operate out, or name a run")]
    OperateLog,
    /// The log cannot be read.
    #[error("{}", .source.of(.path))]
    Log {
        /// Path of the file.
        path: PathBuf,
        /// Error of reading it.
        source: record::ReadError,
    },
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
    /// The terminal cannot be used.
    #[error(
        "the terminal cannot be used: {0}; standard input and output must be a terminal, or use --once SCREEN"
    )]
    Terminal(#[source] io::Error),
    /// Signals cannot be caught.
    #[error("the signal handler cannot be installed: {0}")]
    Signals(#[source] io::Error),
    /// The answer cannot be written.
    #[error("the answer cannot be written: {0}")]
    Output(#[source] io::Error),
}
