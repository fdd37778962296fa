//! What keeps a run from beginning: usage, configuration and data errors. Exit status 2.

use std::{io, path::PathBuf};

use executive::{
    boards::{MemberError, SplitError},
    memory::{ReadError, SharedMemoryError},
    serial::OpenError,
};
use neighbours::{
    data_system::{OutboxError, StoreError},
    network::{address::AddressError, hello::SecretError, listener::ListenError},
};
use plant::{CellError, fault::text::FaultFileError};
use record::RecordError;
use taskdata::load::Diagnostics;

/// Exit status of a job that failed.
pub const FAILED: u8 = 1;
/// Exit status of a usage, configuration or data error.
pub const UNUSABLE: u8 = 2;
/// Exit status of a run that an emergency stop or a lost link ended.
pub const STOPPED: u8 = 3;

/// Why nothing was run.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The data directory is not there.
    #[error("there is no task data directory {}; name one with --data", .0.display())]
    NoData(PathBuf),
    /// Task data or the job has errors.
    #[error("{what} cannot be used: {}", count(.report))]
    Data {
        /// Which.
        what: String,
        /// All that was found.
        report: Box<Diagnostics>,
    },
    /// A command cannot be explained.
    #[error("nothing can be explained: {0}")]
    Explain(String),
    /// There is no such job.
    #[error("there is no job {job}: {}", known_jobs(.known))]
    NoJob {
        /// As asked for.
        job: String,
        /// Jobs of the data directory.
        known: Vec<String>,
    },
    /// A file that is needed cannot be read.
    #[error("{} cannot be read: {source}", path.display())]
    Read {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file that was asked for cannot be written.
    #[error("{} cannot be written: {source}", path.display())]
    Write {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The cell cannot be built.
    #[error("the cell cannot be built: {0}")]
    Cell(#[from] CellError),
    /// A robot at a port with a clock that does not wait for it.
    #[error("a robot at a serial port lives in real time: add --clock real")]
    NotInRealTime,
    /// A run cannot be forked.
    #[error("the run cannot be forked: {0}")]
    Fork(String),
    /// A campaign asks for what there is not.
    #[error("{0}")]
    Campaign(String),
    /// Faults for a line that has its own.
    #[error("the file has faults of the line to the simulated robot; a serial port has faults of its own")]
    FaultsAtPort,
    /// The file of faults cannot be used.
    #[error("the faults cannot be injected: {0}")]
    Faults(#[from] FaultFileError),
    /// The port cannot be opened.
    #[error("the robot cannot be reached: {0}")]
    Port(#[from] OpenError),
    /// The simulated robot has no port.
    #[error("the simulated robot has no line to test: name a port with --robot serial:PATH")]
    NoLinkToTest,
    /// The data base of the Data System cannot be had.
    #[error("the Data System cannot keep its items: {0}")]
    DataBase(#[from] StoreError),
    /// Another process keeps the items.
    #[error("the Data System is another process: name the data base there, not here")]
    DataBaseElsewhere,
    /// Updates for the Data System cannot be kept.
    #[error("{0}; --outbox names another file")]
    Outbox(#[from] OutboxError),
    /// Neighbours cannot connect.
    #[error("neighbours cannot connect: {0}")]
    Network(#[from] ListenError),
    /// Options of the network do not fit together.
    #[error("neighbours cannot connect: {0}")]
    Address(#[from] AddressError),
    /// The secret cannot be used.
    #[error(transparent)]
    Secret(#[from] SecretError),
    /// The workstation controller has not come.
    #[error("the workstation controller has not come within {0} s; --wait gives it more")]
    NobodyCommands(u32),
    /// The log cannot be written.
    #[error("the log cannot be written: {0}; --log names another file, --log none runs without")]
    Log(#[from] RecordError),
    /// Signals cannot be caught.
    #[error("interrupts cannot be caught: {0}")]
    Signals(io::Error),
    /// Shared memory cannot be looked at.
    #[error(transparent)]
    SharedMemory(#[from] SharedMemoryError),
    /// The buffers of a run cannot be read.
    #[error("the run cannot be read: {0}")]
    Unreadable(#[from] ReadError),
    /// There are several runs.
    #[error("there are several runs, name one: {}", .0.join(", "))]
    WhichRun(Vec<String>),
    /// The boards of a run did not come together.
    #[error("the boards did not come together: {0}")]
    Boards(#[from] SplitError),
    /// A board cannot take part in a run.
    #[error(transparent)]
    Board(#[from] MemberError),
    /// The result cannot be written.
    #[error("the result cannot be written: {0}")]
    Output(#[from] io::Error),
}

impl Error {
    /// What is to be said before the last line; empty, or lines that end.
    #[must_use]
    pub fn details(&self) -> String {
        match self {
            Self::Data { report, .. } => report.render_for_stderr(),
            _ => String::new(),
        }
    }
}

fn count(report: &Diagnostics) -> String {
    match report.errors().count() {
        1 => "1 error".to_owned(),
        count => format!("{count} errors"),
    }
}

fn known_jobs(known: &[String]) -> String {
    match known {
        [] => "the data directory has no jobs".to_owned(),
        [only] => format!("the data directory has {only}"),
        more => format!("the data directory has {}", more.join(", ")),
    }
}
