//! `rcs-neighbour`: neighbour systems of the controller as separate processes; `rcs-gateway` carries them to other
//! machines.
//!
//! Each process connects to the mailboxes of a run (`rcs-run --network … --outside …`) and replaces the neighbour in
//! the controller's process. Other programs can use the same byte formats: docs/neighbours.md.

mod cli;
mod data_system;
mod pedestal;
mod vision;
mod workstation;

use std::{
    process::ExitCode,
    thread,
    time::{Duration, Instant},
};

use plant::description::DescriptionError;
use programs::pages::KEYS_MOVED;
use sessions::{
    data_system::StoreError,
    network::{AttachError, Peer, PeerError, Role},
};
use taskdata::load::Diagnostics;

use crate::cli::{Cli, Command, ControllerArguments};

/// Exit status if a job failed or a connection broke.
const FAILED: u8 = 1;
/// Exit status of a usage, configuration or data error.
const UNUSABLE: u8 = 2;

#[derive(Debug, thiserror::Error)]
enum Error {
    /// The controller cannot be reached, or has closed the connection.
    #[error(transparent)]
    Peer(#[from] PeerError),
    #[error("{KEYS_MOVED}")]
    KeysMoved,
    /// The database cannot be used.
    #[error("the items cannot be kept: {0}")]
    DataBase(#[from] StoreError),
    /// The cell description cannot be used.
    #[error("the cell description cannot be used: {0}")]
    Cell(#[from] DescriptionError),
    /// The cell descriptions of the run and of this process differ.
    #[error(
        "camera and parts are {expected:016x}, those of the run {found:016x}: name the data of the run with --data"
    )]
    AnotherCell { expected: u64, found: u64 },
    /// Task data or the job have errors.
    #[error("{what} cannot be used")]
    Data { what: String, report: Box<Diagnostics> },
    /// The job does not exist.
    #[error(transparent)]
    NoJob(#[from] diagnostics::UnknownFile),
    #[error("{0}")]
    Job(String),
}

impl Error {
    const fn status(&self) -> u8 {
        match self {
            Self::Peer(_) | Self::Job(_) => FAILED,
            Self::KeysMoved
            | Self::DataBase(_)
            | Self::Cell(_)
            | Self::AnotherCell { .. }
            | Self::NoJob(_)
            | Self::Data { .. } => UNUSABLE,
        }
    }
}

fn main() -> ExitCode {
    programs::shipped::carry();
    let cli: Cli = programs::pages::parse();
    let outcome = match cli.command {
        Command::Workstation(arguments) => workstation::play(&arguments),
        Command::DataSystem(arguments) => data_system::serve(&arguments),
        Command::Pedestal(arguments) => pedestal::serve(&arguments),
        Command::Vision(arguments) => vision::serve(&arguments),
        Command::Keys { .. } => Err(Error::KeysMoved),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if let Error::Data { report, .. } = &error {
                os_io::console::stderr_drawn(report.render_for_stderr().trim_end());
            }
            os_io::stderr_line!("rcs-neighbour: {error}");
            ExitCode::from(error.status())
        }
    }
}

/// Shortest pause before another attempt to connect.
const SHORTEST: Duration = Duration::from_millis(50);
/// Longest pause before another attempt to connect.
const LONGEST: Duration = Duration::from_secs(2);
/// After a connection that lasted at least this long, the next attempt follows without a pause.
const GOOD: Duration = Duration::from_secs(1);
/// Time within which the controller detects a closed connection.
const CLOSE_DETECTION: Duration = Duration::from_secs(5);

/// Waiting for a controller is announced after this time.
const ANNOUNCE_AFTER: Duration = Duration::from_secs(2);

/// Pauses between attempts to connect, which grow while connections are short.
struct Reconnect {
    since: Instant,
    pause: Duration,
}

impl Reconnect {
    fn new() -> Self {
        Self { since: Instant::now(), pause: Duration::ZERO }
    }

    /// Sleeps before the next attempt.
    fn wait(&mut self) {
        self.pause = pause(self.pause, self.since.elapsed());
        thread::sleep(self.pause);
        self.since = Instant::now();
    }
}

/// The pause after a connection or attempt of the duration `lasted`; `before` is the previous pause.
fn pause(before: Duration, lasted: Duration) -> Duration {
    if lasted >= GOOD + before { Duration::ZERO } else { (before * 2).clamp(SHORTEST, LONGEST) }
}

/// Connects again, to the same run or the next one; `None` if no run connects within the waiting time.
fn connect_again(
    arguments: &ControllerArguments,
    role: Role,
    reconnect: &mut Reconnect,
) -> Result<Option<Peer>, Error> {
    let occupied = AttachError::Occupied(role).to_string();
    let started = Instant::now();
    while started.elapsed() < CLOSE_DETECTION {
        reconnect.wait();
        match connect(arguments, role) {
            Err(Error::Peer(PeerError::Disconnected(why))) if why == occupied => {}
            Err(Error::Peer(error)) if error.is_passing() => return Ok(None),
            other => return other.map(Some),
        }
    }
    connect(arguments, role).map(Some)
}

fn connect(arguments: &ControllerArguments, role: Role) -> Result<Peer, Error> {
    let wait = Duration::from_secs(arguments.wait);
    let address = &arguments.network;
    let soon = wait.min(ANNOUNCE_AFTER);
    match Peer::connect_within(soon, address, role) {
        Err(error) if error.is_passing() && soon < wait => {
            os_io::stderr_line!(
                "rcs-neighbour: {error}; waiting for a controller, {} s at most (--wait)",
                wait.as_secs()
            );
            Ok(Peer::connect_within(wait - soon, address, role)?)
        }
        outcome => Ok(outcome?),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pauses_grow_until_a_connection_lasts() {
        let mut pauses = vec![Duration::ZERO];
        for _ in 0..8 {
            pauses.push(pause(*pauses.last().unwrap(), Duration::ZERO));
        }
        let milliseconds: Vec<u128> = pauses.iter().map(Duration::as_millis).collect();
        assert_eq!(milliseconds, [0, 50, 100, 200, 400, 800, 1600, 2000, 2000]);
        assert_eq!(pause(SHORTEST, Duration::from_secs(5)), Duration::ZERO);
    }
}
