//! Why the console does not begin, or ends.

use std::{io, path::PathBuf};

use executive::memory::SharedMemoryError;

/// Why the console does not begin, or ends.
#[derive(Debug, thiserror::Error)]
pub enum ConsoleError {
    /// No such run, or it cannot be read.
    #[error(transparent)]
    SharedMemory(#[from] SharedMemoryError),
    /// A run that takes no operator.
    #[error(transparent)]
    Operator(#[from] operator::ClientError),
    /// A log is no run.
    #[error("a log cannot be operated: leave --operate out, or name a run")]
    OperateLog,
    /// A log that cannot be read.
    #[error("{}: {source}", path.display())]
    Log {
        /// The file.
        path: PathBuf,
        /// Why.
        source: record::ReadError,
    },
    /// A log without ticks.
    #[error("{}: the log holds no tick: nothing can be shown", .0.display())]
    Empty(PathBuf),
    /// A tick that the log does not have.
    #[error("tick {tick} is not there; there are ticks {first} to {last}")]
    NoTick {
        /// As asked for.
        tick: u64,
        /// First tick there.
        first: u64,
        /// Last tick there.
        last: u64,
    },
    /// Nothing was named to be looked at once.
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
