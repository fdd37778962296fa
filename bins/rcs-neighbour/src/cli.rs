//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use cli_pages::shipped_path;
use neighbours::network::Address;

use crate::vision::Fault;

/// Neighbours of the RCS-II/T3 controller as processes of their own.
#[derive(Debug, Parser)]
#[command(
    name = "rcs-neighbour",
    version,
    about,
    after_help = "\
Examples:
  rcs-run --network unix:/tmp/rcs.sock --outside workstation
                                       a controller that waits for a workstation controller
  rcs-neighbour workstation --network unix:/tmp/rcs.sock linkbar
                                       and one that plays the linkbar
  rcs-run shift --network unix:/tmp/rcs.sock --outside data-system
                                       a run that keeps no items itself
  rcs-neighbour data-system --network unix:/tmp/rcs.sock items.db
                                       and the process that keeps them: sqlite3 items.db 'SELECT * FROM whereabouts'
  rcs-run clevis --network unix:/tmp/rcs.sock --outside pedestal
                                       a run whose pedestal is a system of its own
  rcs-neighbour pedestal --network unix:/tmp/rcs.sock
                                       and the pedestal
  rcs-run clevis --network unix:/tmp/rcs.sock --outside vision
                                       a run whose pictures are analysed elsewhere
  rcs-neighbour vision --network unix:/tmp/rcs.sock --fault 2:not-recognised
                                       and the vision system, which fails at the second one
  rcs-neighbour keys cell-keys         keys for neighbours on other machines:
  rcs-run --clock real --network tcp:10.0.0.1:7400 --keys cell-keys --outside workstation
  rcs-neighbour workstation --network tcp:10.0.0.1:7400 --keys cell-keys linkbar

Exit status: 0 finished; 1 the job failed or the connection broke; 2 usage, configuration or data error."
)]
pub struct Cli {
    /// Which neighbour.
    #[command(subcommand)]
    pub command: Command,
}

/// The neighbours.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// The workstation controller (HWSC): plays a job
    Workstation(WorkstationArguments),
    /// The Data System: keeps items in an SQLite file, for one run after the other, until none has come for a while
    DataSystem(DataSystemArguments),
    /// The Active Pedestal, with its devices in the simulated cell: for one run after the other, until none
    /// has come for a while
    Pedestal(PedestalArguments),
    /// The vision system: analyses what the camera of the cell sees, for one run after the other, until none
    /// has come for a while
    Vision(VisionArguments),
    /// Make an authority, and keys and certificates for the controller and all neighbours; what is there stays
    Keys(KeysArguments),
}

/// Where the controller is.
#[derive(Clone, Debug, Args)]
pub struct ControllerArguments {
    /// Where the run waits for its neighbours: unix:PATH, tcp:IP:PORT or zenoh:NAME or zenoh:NAME@ENDPOINT
    #[arg(long, value_name = "ADDRESS")]
    pub network: Address,
    /// Directory with keys and certificates for tcp: and zenoh:, as `rcs-neighbour keys` makes it
    #[arg(long, value_name = "DIR")]
    pub keys: Option<PathBuf>,
    /// File with Zenoh's own configuration (JSON5): TLS, access control, routers
    #[arg(long, value_name = "FILE")]
    pub zenoh_config: Option<PathBuf>,
    /// How long to wait for the run
    #[arg(long, value_name = "SECONDS", default_value_t = 60)]
    pub wait: u64,
}

/// Arguments of `keys`.
#[derive(Clone, Debug, Args)]
pub struct KeysArguments {
    /// Directory for the files, which is made if it is not there. To renew a certificate, delete its two files first
    #[arg(value_name = "DIR")]
    pub directory: PathBuf,
    /// How long the certificates are valid; the authority is valid for 3650 days
    #[arg(long, value_name = "N", default_value_t = 825, value_parser = clap::value_parser!(u16).range(..=3650))]
    pub days: u16,
}

/// Arguments of `workstation`.
#[derive(Clone, Debug, Args)]
pub struct WorkstationArguments {
    /// Where the controller is.
    #[command(flatten)]
    pub controller: ControllerArguments,
    /// Name of a job in the data directory, or a path
    #[arg(default_value = "linkbar")]
    pub job: String,
    /// Task data, against which the job is checked, and jobs
    #[arg(long, value_name = "DIR", default_value = "data", value_parser = shipped_path())]
    pub data: PathBuf,
    /// After a command that ends with an error send PAUSE and the same command again, at most so many times a line
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub retry: u32,
}

/// Arguments of `data-system`.
#[derive(Clone, Debug, Args)]
pub struct DataSystemArguments {
    /// Where the controller is.
    #[command(flatten)]
    pub controller: ControllerArguments,
    /// The SQLite file, which is made if it is not there
    #[arg(value_name = "FILE")]
    pub data_base: PathBuf,
}

/// Arguments of `pedestal`.
#[derive(Clone, Debug, Args)]
pub struct PedestalArguments {
    /// Where the controller is.
    #[command(flatten)]
    pub controller: ControllerArguments,
}

/// Arguments of `vision`.
#[derive(Clone, Debug, Args)]
pub struct VisionArguments {
    /// Where the controller is.
    #[command(flatten)]
    pub controller: ControllerArguments,
    /// Where the cell description of the run is: cell.toml
    #[arg(long, value_name = "DIR", default_value = "data", value_parser = shipped_path())]
    pub data: PathBuf,
    /// Let pictures go wrong, counted from 1 over all runs: N:KIND or N-M:KIND, with commas between them
    ///
    /// off: no answer; camera-blind: nothing is seen; not-recognised; another-object: that is recognised;
    /// another-echo: the answer is to another request; input-not-ready: it stands where vision-ready-input is
    /// 1; output-not-ready: vision-ready-output is 1 from then on; garbled: a status that there is not;
    /// truncated; outside: the centroid is 300 in away; turned: by 270 degrees; gone: the line is cut in the
    /// middle, and made again.
    #[arg(long, value_name = "FAULTS", value_delimiter = ',')]
    pub fault: Vec<Fault>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory as _;

    #[test]
    fn the_definitions_are_consistent() {
        Cli::command().debug_assert();
    }
}
