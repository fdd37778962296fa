//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use programs::pages::{DataArgument, RemovedTls};
use sessions::network::Address;

use crate::vision::fault::Fault;

/// Neighbour systems of the RCS-II/T3 controller, as separate processes.
#[derive(Debug, Parser)]
#[command(
    name = "rcs-neighbour",
    version,
    about = "Neighbour systems of the RCS-II/T3 controller, as separate processes",
    after_help = "\
Examples:
  rcs-run --network unix:/tmp/rcs.sock --outside workstation
                                       a controller that waits for a workstation controller
  rcs-neighbour workstation --network unix:/tmp/rcs.sock linkbar
                                       and one that plays the linkbar
  rcs-run shift --network unix:/tmp/rcs.sock --outside data-system
                                       a run that does not keep the items itself
  rcs-neighbour data-system --network unix:/tmp/rcs.sock items.db
                                       and the process that keeps them: sqlite3 items.db 'SELECT * FROM whereabouts'
  rcs-run clevis --network unix:/tmp/rcs.sock --outside pedestal
                                       a run whose pedestal is another process
  rcs-neighbour pedestal --network unix:/tmp/rcs.sock
                                       and the pedestal
  rcs-run clevis --network unix:/tmp/rcs.sock --outside vision
                                       a run whose pictures are analysed elsewhere
  rcs-neighbour vision --network unix:/tmp/rcs.sock --fault 2:not-recognised
                                       and the vision system, which fails at the second picture

On another machine connect to the socket of `rcs-gateway connect` (docs/several-machines.md).

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
    /// The Data System: keeps items in an SQLite file. Serves one run after the other; exits when no run comes within
    /// --wait
    DataSystem(DataSystemArguments),
    /// The Active Pedestal, with its devices in the simulated cell. Serves one run after the other; exits when no run
    /// comes within --wait
    Pedestal(PedestalArguments),
    /// The vision system: analyses the pictures of the cell's camera. Serves one run after the other; exits when no run
    /// comes within --wait
    Vision(VisionArguments),
    /// Keys are made by tools/keys.sh
    #[command(hide = true)]
    Keys {
        /// Arguments of earlier versions.
        #[arg(num_args = 0.., trailing_var_arg = true, allow_hyphen_values = true)]
        rest: Vec<String>,
    },
}

/// Where the controller is.
#[derive(Clone, Debug, Args)]
pub struct ControllerArguments {
    /// Address at which the run, or `rcs-gateway connect` for a run on another machine, waits for its neighbours:
    /// unix:PATH
    #[arg(long, value_name = "ADDRESS")]
    pub network: Address,
    /// Options that no longer exist.
    #[command(flatten)]
    pub removed: RemovedTls,
    /// Seconds to wait for a run
    #[arg(long, value_name = "SECONDS", default_value_t = 60)]
    pub wait: u64,
}

/// Arguments of `workstation`.
#[derive(Clone, Debug, Args)]
pub struct WorkstationArguments {
    /// Where the controller is.
    #[command(flatten)]
    pub controller: ControllerArguments,
    /// Name of a job in the data directory, or a path
    #[arg(default_value = "linkbar", value_parser = programs::pages::job(), hide_possible_values = true)]
    pub job: String,
    /// The data.
    #[command(flatten)]
    pub data: DataArgument,
    /// After a command that ends with an error, send PAUSE and the same command again, at most N times for a line of
    /// the job
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub retry: u32,
}

/// Arguments of `data-system`.
#[derive(Clone, Debug, Args)]
pub struct DataSystemArguments {
    /// Where the controller is.
    #[command(flatten)]
    pub controller: ControllerArguments,
    /// The SQLite file, created if missing
    #[arg(value_name = "FILE")]
    pub database: PathBuf,
}

/// Arguments of `pedestal`.
#[derive(Clone, Debug, Args)]
pub struct PedestalArguments {
    /// Where the controller is.
    #[command(flatten)]
    pub controller: ControllerArguments,
}

/// The help of `vision --data`.
const VISION_DATA: &str = "Directory with the cell description of the run, cell.toml [default: data; if there is \
                           none: built-in, the data of the program]";

/// Arguments of `vision`.
#[derive(Clone, Debug, Args)]
#[command(mut_arg("data", |data| data.help(VISION_DATA)))]
pub struct VisionArguments {
    /// Where the controller is.
    #[command(flatten)]
    pub controller: ControllerArguments,
    /// The data.
    #[command(flatten)]
    pub data: DataArgument,
    /// Faults of pictures, separated by commas: N:KIND or N-M:KIND; pictures count from 1 over all runs
    ///
    /// off: no answer; camera-blind: the camera sees nothing; not-recognised: the object is not recognised;
    /// another-object: another object is recognised; another-echo: the answer echoes another request; input-not-ready:
    /// vision-ready-input is 1 with the answer; output-not-ready: vision-ready-output is 1 from this picture on;
    /// garbled: a status value that does not exist; truncated: the answer is too short; outside: the centroid is 300 in
    /// away; turned: the angle is 270 degrees; gone: the connection is closed before the answer, and opened again.
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
