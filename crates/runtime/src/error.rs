//! Errors of the start of a run.

use std::{io, path::PathBuf};

use diagnostics::UnknownFile;
use executive::{boards::SplitError, memory::SharedMemoryError, serial::OpenError};
use os_io::console::shown;
use os_io::text::amount;
use plant::CellError;
use record::{RecordError, journal::JournalError};
use sessions::{
    data_system::{OutboxError, StoreError},
    network::{Address, listener::ListenError},
};
use taskdata::load::Diagnostics;

#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StartError {
    #[error("there is no task data directory {}; name one with --data", .0.display())]
    NoData(PathBuf),
    #[error("{what} cannot be used: {}", amount(.report.errors().count(), "error"))]
    Data { what: String, report: Box<Diagnostics> },
    /// Commands of the job use records of the task data that have errors.
    #[error(
        "the job {job} cannot be run: {} with errors in the data; rcs-run check shows all errors, --unchecked runs it",
        amount(.wrong.len(), "command")
    )]
    WrongData {
        job: String,
        wrong: Vec<String>, // one line per command, with its first error
    },
    #[error(transparent)]
    NoFile(#[from] UnknownFile),
    #[error("{} cannot be read: {source}", path.display())]
    Read { path: PathBuf, source: io::Error },
    #[error("the cell cannot be built: {0}")]
    Cell(#[from] CellError),
    #[error("a robot at a port needs real time: add --clock real")]
    NotInRealTime,
    #[error("a speed from 1 to {most} times real time was expected, found {0}", most = crate::config::MOST_SPEED)]
    Speed(u8),
    #[error("the configuration names a robot of the caller's own: start the run by Run::with_robot")]
    NoOwnRobot,
    #[error("the file has faults of the line to the simulated robot; leave them out for any other robot")]
    FaultsAtPort,
    #[error("the field I/O cannot start: {0}")]
    Field(#[from] closed_loop::field::FieldError),
    #[error("the mapping of --field cannot execute the job: {}", .0.join("; "))]
    LinesWithoutDevices(Vec<String>),
    #[error("the robot is not the simulated one, and the job operates its panel: {}", .0.join("; "))]
    PanelElsewhere(Vec<String>),
    /// Couplers over TCP need a clock in real time.
    #[error(
        "couplers over TCP need real time: add --clock real, or use --field sim:NAME for emulated couplers"
    )]
    FieldNotInRealTime,
    #[error("the field I/O cannot start: {device}: {source}")]
    FieldDevice { device: String, source: executive::field::DeviceError },
    #[error("the field I/O cannot start: {}", .0.join("; "))]
    FieldNotReady(Vec<String>),
    #[error("the fault file cuts the connection of {0:?}, which needs emulated couplers: --field sim:NAME")]
    CutOverTcp(String),
    #[error("the fault file cuts the connection of {device:?}: expected {expected}")]
    NoSuchDevice { device: String, expected: String },
    #[error("the robot cannot be reached: {0}")]
    Port(#[from] OpenError),
    #[error("the robot cannot be reached: {0}")]
    Egm(#[from] executive::egm::udp::UdpError),
    #[error(transparent)]
    Placement(#[from] executive::egm::placement::PlacementError),
    #[error("the operator's inputs cannot be replayed: {0}")]
    Inputs(#[source] Box<record::ReadError>),
    #[error("the operator's inputs cannot be replayed: {}: {part}; name the log of a whole run", path.display())]
    LaterInputs { path: PathBuf, part: record::Part },
    #[error("the Data System cannot keep its items: {0}")]
    DataBase(#[from] StoreError),
    #[error("the Data System is another process: name the database there, not here")]
    DataBaseElsewhere,
    #[error("{0}; --outbox names another file")]
    Outbox(#[from] OutboxError),
    #[error(
        "an operator is not a neighbour: --operator network lets operators connect, not --outside operator"
    )]
    OperatorOutside,
    /// An address requires a neighbour or an operator that may connect there.
    #[error(
        "nobody may connect at the address of --network: add --outside for neighbours, or --operator network"
    )]
    NobodyConnects,
    /// Operators of a network need a run that accepts them, and an address.
    #[error(
        "--operator network needs --clock real or a speed such as 5x, --shared-memory on, and --network or --live"
    )]
    OperatorNetwork,
    /// A job on stand-by would wait forever.
    #[error(
        "--stand-by waits for an operator, and none can connect: add --clock real, --operator owner, \
         --shared-memory on"
    )]
    StandBy,
    /// A resumed job would wait forever.
    #[error(
        "a resumed job waits for an operator, and none can connect: add --clock real, --operator owner, \
         --shared-memory on"
    )]
    ResumeStandBy,
    #[error("{}{}", .0, way_out(.0))]
    Journal(#[from] JournalError),
    #[error(
        "the log {} cannot be used: {source}; without --resume the run starts as after switching on, and knows nothing",
        path.display()
    )]
    ResumedLog { path: PathBuf, source: record::journal::LoggedError },
    /// The journal belongs to a run with other data.
    #[error(
        "{} belongs to another run: {}; start with the data, job and cell of that run, or without --resume",
        path.display(), differences.join("; ")
    )]
    OtherJournal { path: PathBuf, differences: Vec<String> },
    #[error("the run of {} has ended: nothing is left to resume; start without --resume", .0.display())]
    NothingToResume(PathBuf),
    /// The simulated cell cannot continue.
    #[error(
        "the simulated cell of the run cannot continue: {}: {why}; with --resume LOG name the journal beside which it \
         is saved with --journal; without --resume the run sets up a new cell",
        path.display()
    )]
    ResumedCell { path: PathBuf, why: String },
    #[error("--stand-by waits for an operator, and none can connect: {}: {source}", path.display())]
    NoOperator { path: PathBuf, source: io::Error },
    #[error("neighbours cannot connect: {0}")]
    Network(#[from] ListenError),
    #[error("neighbours cannot connect: {0}")]
    Endpoint(#[source] io::Error),
    #[error("the workstation controller has not connected within {0} s; --wait N sets a longer time")]
    NoWorkstation(u32),
    #[error("the log cannot be written: {0}; --log names another file, --log none runs without")]
    Log(#[from] RecordError),
    /// The run could remove the log that it repeats.
    #[error(
        "{} is an earlier log of {}, which --log-keep may remove: name another file with --log",
        .inputs.display(), .log.display()
    )]
    InputsOfLog { inputs: PathBuf, log: PathBuf },
    #[error("the live view shows what is written to the log: leave --log none out, or name a log file")]
    LiveWithoutLog,
    #[error("viewers cannot connect at 127.0.0.1:{port}: {source}; --live PORT names another port")]
    Live { port: u16, source: io::Error },
    #[error("rcs-gateway cannot connect at {address}: {source}; --live-socket unix:PATH names another path")]
    LiveSocket { address: Address, source: io::Error },
    #[error("a thread of the run cannot be started: {0}")]
    Thread(#[source] io::Error),
    #[error(transparent)]
    NoRandom(#[from] sessions::live::NoRandom),
    #[error("{0} was stopped by the user before the first tick")]
    Interrupted(String),
    #[error(transparent)]
    NameInUse(SharedMemoryError),
    #[error("not all boards have started: {0}")]
    Boards(#[from] SplitError),
}

impl StartError {
    /// All findings in the data, to print with [`os_io::console::stderr_drawn`] before the error; empty or whole lines.
    #[must_use]
    pub fn details(&self) -> String {
        match self {
            Self::Data { report, .. } => report.render_for_stderr(),
            Self::WrongData { wrong, .. } => wrong.iter().map(|line| format!("{}\n", shown(line))).collect(),
            _ => String::new(),
        }
    }
}

/// What a person can do if the journal of an earlier run cannot be used.
const fn way_out(error: &JournalError) -> &'static str {
    match error {
        JournalError::Read { .. } | JournalError::Format { .. } => {
            "; --resume LOG starts with the last image of its log; without --resume the run starts as after switching \
             on, and knows nothing"
        }
        _ => "",
    }
}
