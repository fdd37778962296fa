use std::{io, path::PathBuf};

use executive::memory::SharedMemoryError;

#[derive(Debug, thiserror::Error)]
pub enum ConsoleError {
    #[error(transparent)]
    SharedMemory(#[from] SharedMemoryError),
    #[error(transparent)]
    Operator(#[from] sessions::operator::ClientError),
    #[error("a log cannot be operated: leave --operate out, or name a run")]
    OperateLog,
    #[error("{}", .source.of(.path))]
    Log { path: PathBuf, source: record::ReadError },
    #[error("{}: the log holds no tick: nothing can be shown", .0.display())]
    Empty(PathBuf),
    #[error("tick {tick} is not there; there are ticks {first} to {last}")]
    NoTick {
        tick: u64,  // the requested tick
        first: u64, // first tick of the log
        last: u64,  // last tick of the log
    },
    #[error("--once needs a run or a log: --run NAME or --log FILE")]
    NothingNamed,
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
