//! Errors of the subcommands: usage, configuration and data errors, and an interruption before the first tick.

use std::{io, path::PathBuf};

use executive::{
    boards::MemberError,
    memory::{ReadError, SharedMemoryError},
};
use runtime::StartError;
use sessions::network::PeerError;

pub const FAILED: u8 = 1; // exit status of a job that failed
pub const UNUSABLE: u8 = 2; // exit status of a usage, configuration or data error
pub const STOPPED: u8 = 3; // exit status of a run that the user, an emergency stop or a lost link ended

#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Start(#[from] StartError),
    #[error(transparent)]
    SharedMemory(#[from] SharedMemoryError),
    #[error("nothing can be explained: {0}")]
    Explain(String),
    #[error("the reach of the robot cannot be checked: {0}")]
    Reach(String),
    #[error("the pose cannot be shown or written: {0}")]
    Pose(String),
    #[error("nothing is written: {0}")]
    New(String),
    #[error("{} cannot be written: {source}", path.display())]
    Write { path: PathBuf, source: io::Error },
    #[error("{} cannot be read: {source}", path.display())]
    Unlisted { path: PathBuf, source: io::Error },
    /// A robot at a port, or couplers over TCP, without data named by the user.
    #[error(
        "a robot at a port, or couplers over TCP, need the data of their cell: --data DIR, or those of the program \
         with --data built-in"
    )]
    BuiltInAtPort,
    #[error("there is no job {word}: the nearest is the subcommand {subcommand}")]
    Subcommand { word: String, subcommand: String },
    #[error("the run cannot be forked: {0}")]
    Fork(String),
    #[error("{0}")]
    Campaign(String),
    #[error("{0}")]
    Field(String),
    #[error("the simulated robot has no line to test: name a port with --robot serial:PATH")]
    NoLinkToTest,
    #[error("the signal handler cannot be installed: {0}")]
    Signals(io::Error),
    #[error("the run cannot be read: {0}")]
    Unreadable(#[from] ReadError),
    #[error("there are several runs, name one: {}", .0.join(", "))]
    WhichRun(Vec<String>),
    #[error(transparent)]
    Operator(#[from] sessions::operator::ClientError),
    #[error(transparent)]
    Network(#[from] PeerError),
    #[error(transparent)]
    Board(#[from] MemberError),
    /// The console is not installed.
    #[error(
        "the console is missing: {} was expected; cargo build --release --bin rcs-console makes it",
        .0.display()
    )]
    NoConsole(PathBuf),
    #[error("the console cannot be started: {0}")]
    Console(io::Error),
    #[error("the result cannot be written: {0}")]
    Output(#[from] io::Error),
}

impl Error {
    /// The exit status. A stop by the user before the first tick has the same status as a later stop.
    #[must_use]
    pub const fn status(&self) -> u8 {
        match self {
            Self::Start(StartError::Interrupted(_)) => STOPPED,
            _ => UNUSABLE,
        }
    }

    /// Lines to print before the last line; empty or ending with a newline.
    #[must_use]
    pub fn details(&self) -> String {
        match self {
            Self::Start(error) => error.details(),
            _ => String::new(),
        }
    }
}
