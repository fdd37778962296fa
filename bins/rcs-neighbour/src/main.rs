//! `rcs-neighbour`: neighbours of the controller as processes of their own, on this machine or on another.
//!
//! Each connects to the mailboxes of a run (`rcs-run --network … --outside …`) and does there what the one in the controller's
//! process would do. Programs of others speak the same bytes: docs/neighbours.md.

mod cli;
mod data_system;
mod pedestal;
mod vision;
mod workstation;

use std::{process::ExitCode, thread, time::Duration};

use clap::Parser as _;
use neighbours::{
    data_system::StoreError,
    network::{
        Peer, PeerError, Role, Secret, address::AddressError, hello::SecretError, office::AttachError,
    },
};
use plant::description::DescriptionError;
use taskdata::load::Diagnostics;

use crate::cli::{Cli, Command, ControllerArguments};

/// Exit status of a job that failed, or a connection that broke.
const FAILED: u8 = 1;
/// Exit status of a usage, configuration or data error.
const UNUSABLE: u8 = 2;

/// Why a neighbour ends before its time.
#[derive(Debug, thiserror::Error)]
enum Error {
    /// The controller cannot be reached, or has gone.
    #[error(transparent)]
    Peer(#[from] PeerError),
    /// The secret cannot be used.
    #[error(transparent)]
    Secret(#[from] SecretError),
    /// Options of the network do not fit together.
    #[error(transparent)]
    Address(#[from] AddressError),
    /// The data base cannot be had.
    #[error("the items cannot be kept: {0}")]
    DataBase(#[from] StoreError),
    /// The cell description cannot be used.
    #[error("the cell description cannot be used: {0}")]
    Cell(#[from] DescriptionError),
    /// The run has another cell than this process.
    #[error(
        "the cell description of the run was expected: camera and parts have the fingerprint {found:016x} there, and here \
         {expected:016x}; name its directory with --data"
    )]
    AnotherCell {
        /// Of the description here.
        expected: u64,
        /// Of the run's.
        found: u64,
    },
    /// Task data or the job have errors.
    #[error("{what} cannot be used")]
    Data {
        /// Which.
        what: String,
        /// All that was found.
        report: Box<Diagnostics>,
    },
    /// The job came to nothing.
    #[error("{0}")]
    Job(String),
}

impl Error {
    const fn status(&self) -> u8 {
        match self {
            Self::Peer(error) if error.is_usage() => UNUSABLE,
            Self::Peer(_) | Self::Job(_) => FAILED,
            Self::Address(_)
            | Self::Secret(_)
            | Self::DataBase(_)
            | Self::Cell(_)
            | Self::AnotherCell { .. }
            | Self::Data { .. } => UNUSABLE,
        }
    }
}

fn main() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Workstation(arguments) => workstation::play(&arguments),
        Command::DataSystem(arguments) => data_system::serve(&arguments),
        Command::Pedestal(arguments) => pedestal::serve(&arguments),
        Command::Vision(arguments) => vision::serve(&arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if let Error::Data { report, .. } = &error {
                os_io::stderr_line!("{}", report.render_for_stderr().trim_end());
            }
            os_io::stderr_line!("rcs-neighbour: {error}");
            ExitCode::from(error.status())
        }
    }
}

/// Between two attempts while the controller has not yet noticed that the line was cut.
const PAUSE: Duration = Duration::from_millis(50);
/// Such attempts: 5 s, more than it needs.
const ATTEMPTS: u32 = 100;

/// Connect for another run, or since the line was cut; `None` if no run has come for a while.
fn connect_again(arguments: &ControllerArguments, role: Role) -> Result<Option<Peer>, Error> {
    let occupied = AttachError::Occupied(role).to_string();
    for _ in 0..ATTEMPTS {
        match connect(arguments, role) {
            Err(Error::Peer(PeerError::LastWords(why))) if why == occupied => thread::sleep(PAUSE),
            Err(Error::Peer(error)) if error.is_passing() => return Ok(None),
            other => return other.map(Some),
        }
    }
    connect(arguments, role).map(Some)
}

/// Connect to the controller.
fn connect(arguments: &ControllerArguments, role: Role) -> Result<Peer, Error> {
    let secret = arguments.secret.as_deref().map(Secret::load).transpose()?;
    let wait = Duration::from_secs(arguments.wait);
    let address = arguments.network.clone().configured(arguments.zenoh_config.clone())?;
    Ok(Peer::connect_within(wait, &address, role, secret.as_ref())?)
}
