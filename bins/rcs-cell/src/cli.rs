//! The command line.

use std::{path::PathBuf, str::FromStr};

use clap::Parser;
use depc::Limits;
use executive::egm::EgmOptions;
use programs::pages::{DataArgument, fault_file};
use sessions::network::Address;

/// The simulated T3 controller behind a pseudo-terminal: opens as a serial port, speaks DEPC. With --egm a robot
/// with ABB's Externally Guided Motion takes its place; with --emulate it is such a robot itself. With --station it is
/// the whole simulated cell, behind the Modbus couplers of a mapping, EGM and vision.
#[derive(Debug, Parser)]
#[command(
    name = "rcs-cell",
    version,
    about = "The simulated T3 controller behind a pseudo-terminal",
    after_help = "\
Commands are read from standard input, one per line; help lists them. The start-up is that of the manual \
(NBSIR 88-3692, IV.3.3): control power on, fault reset, hydraulics enable, manual on, align, auto, \
cycle start. While a host has the link open, its DTR is treated as on; when it closes the link, the \
controller shows WD1. The end of standard input ends the program if standard input is a terminal; \
otherwise it runs on.

Examples:
  rcs-cell --link /tmp/t3              the console: start the robot step by step
  rcs-cell --link /tmp/t3 --auto       with the start-up done, ready for a host
  rcs-run --robot serial:/tmp/t3 --clock real    a host (in another terminal)
  rcs-cell --link /tmp/t3 --auto --faults noisy-line    the same over a bad line
  rcs-cell --link /tmp/t3 --egm 6510   a gateway: the robot with EGM that sends to UDP port 6510, as a T3
  rcs-cell --emulate egm:6510          an EGM robot that sends to UDP port 6510 of this machine
  rcs-cell --emulate egm:10.0.0.7:6510,gain=10,loss=5,jitter=10    to another machine, over a bad network
  rcs-cell --station station --egm-robot 6510 --vision unix:/tmp/rcs.sock    the whole cell
  rcs-cell --link /tmp/t3 < start.txt  commands from a file; `wait 4` waits between them

Exit status: 0 ended by quit, the end of input or a signal; 1 the pseudo-terminal failed; 2 usage, or \
the path, the mapping or an address cannot be used. The reason is the last line on standard error."
)]
pub struct Cli {
    /// Path of the symbolic link to the pseudo-terminal; no other file may be there
    #[arg(long, value_name = "PATH", required_unless_present_any = ["emulate", "station"])]
    pub link: Option<PathBuf>,
    /// Connect the host to the EGM robot that sends to this UDP port: PORT or ADDRESS:PORT, then options after commas
    ///
    /// Options: robot=NAME|FILE, the robot's frames; from=ADDRESS, ignore datagrams from other addresses;
    /// speed-ref=on|off (on); slack=MS (10), how late a command may be.
    #[arg(long, value_name = "PORT", requires = "link", conflicts_with_all = ["auto", "faults", "emulate"])]
    pub egm: Option<EgmOptions>,
    /// Emulate an EGM robot that sends to this UDP port: egm:PORT or egm:ADDRESS:PORT, then options after commas
    ///
    /// Options of the robot: robot=NAME|FILE, gain=K (5), filter=HZ (20), ramp=S (0.5), deviation=DEG/S (90),
    /// timeout=S (1), do-not-restart=on|off (on). Of the network: loss, double, reorder=PERCENT, delay, jitter=MS,
    /// silent-at, silent-for=S, seed=N.
    #[arg(long, value_name = "egm:PORT", conflicts_with_all = ["link", "auto", "faults"])]
    pub emulate: Option<EgmTarget>,
    /// The simulated cell behind the couplers of a mapping: a name in data/field, or a file. Modbus TCP servers listen
    /// at the addresses of the mapping; the robot is --egm-robot, the camera --vision (docs/real-cell.md)
    #[arg(long, value_name = "NAME|FILE", conflicts_with_all = ["link", "egm", "emulate", "auto", "faults"])]
    pub station: Option<PathBuf>,
    /// The robot of the station: an EGM robot that sends to this UDP port: PORT or ADDRESS:PORT, then options after
    /// commas as for --emulate
    #[arg(long, value_name = "PORT", requires = "station", conflicts_with_all = ["link", "emulate"])]
    #[arg(value_parser = EgmOptions::to_emulate)]
    pub egm_robot: Option<EgmOptions>,
    /// The camera of the station is the neighbour `vision` of a run: unix:PATH of its --network
    #[arg(long, value_name = "ADDRESS", requires = "station", conflicts_with_all = ["link", "emulate"])]
    pub vision: Option<Address>,
    /// The inputs of the station reach its couplers this number of ticks late, to test a controller
    #[arg(long, value_name = "TICKS", default_value_t = 0, requires = "station")]
    #[arg(value_parser = clap::value_parser!(u8).range(..=25))]
    pub delay: u8,
    /// The data.
    #[command(flatten)]
    pub data: DataArgument,
    /// Do the start-up without a person, and press ENTER when a host connects
    #[arg(long)]
    pub auto: bool,
    /// Period of the controller in milliseconds, a multiple of 10 up to 1000, or 19.76 as in appendix A; the velocity
    /// limits apply per period
    #[arg(long, value_name = "MS", default_value = "40", value_parser = period)]
    pub period: Limits,
    /// Seed of the joints' distances from HOME at start-up and of their alignment errors; of the noise of a station's
    /// sensors and of the places of its parts
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Fault plan for the bytes on the line: a name in the data directory, or a file (TOML); its ticks are steps of the
    /// controller, about one per period
    #[arg(long, value_name = "NAME|FILE", value_parser = fault_file(), hide_possible_values = true)]
    pub faults: Option<PathBuf>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct EgmTarget(pub EgmOptions);

impl FromStr for EgmTarget {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let target = text.strip_prefix("egm:").ok_or("egm:[ADDRESS:]PORT[,OPTION...] was expected")?;
        EgmOptions::to_emulate(target).map(Self)
    }
}

fn period(text: &str) -> Result<Limits, String> {
    if text == "19.76" {
        return Ok(Limits::APPENDIX);
    }
    let milliseconds = text.parse().map_err(|_| "milliseconds were expected".to_owned())?;
    Limits::new(milliseconds).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definitions_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn a_robot_with_egm_is_remote_or_simulated_here() {
        programs::shipped::carry();
        let cli = |arguments: &[&str]| Cli::try_parse_from(["rcs-cell"].iter().chain(arguments));
        assert!(cli(&["--link", "x", "--egm", "6510,slack=20"]).is_ok());
        assert!(cli(&["--emulate", "egm:6510,gain=10,loss=5"]).is_ok());
        for wrong in [
            &["--egm", "6510"][..],
            &["--emulate", "6510"],
            &["--emulate", "egm:6510", "--link", "x"],
            &["--emulate", "egm:6510,slack=20,from=x"],
            &["--link", "x", "--egm", "6510,gain=5"],
            &["--link", "x", "--egm", "6510", "--auto"],
        ] {
            assert_eq!(cli(wrong).expect_err("refused").exit_code(), 2, "{wrong:?}");
        }
    }

    #[test]
    fn robot_and_camera_of_a_station_need_the_station() {
        programs::shipped::carry();
        let cli = |arguments: &[&str]| Cli::try_parse_from(["rcs-cell"].iter().chain(arguments));
        assert!(
            cli(&["--station", "station", "--egm-robot", "6510,loss=5", "--vision", "unix:/tmp/x"]).is_ok()
        );
        for wrong in [
            &["--link", "x", "--egm-robot", "6510"][..],
            &["--emulate", "egm:6510", "--vision", "unix:/tmp/x"],
            &["--station", "station", "--link", "x"],
            &["--station", "station", "--egm-robot", "egm:6510"],
            &["--station", "station", "--vision", "/tmp/x"],
        ] {
            assert_eq!(cli(wrong).expect_err("refused").exit_code(), 2, "{wrong:?}");
        }
    }

    #[test]
    fn a_period_is_a_multiple_of_ten_milliseconds() {
        programs::shipped::carry();
        let cli = |period| Cli::try_parse_from(["rcs-cell", "--link", "x", "--period", period]);
        assert_eq!(cli("20").map(|cli| cli.period.period_us()).ok(), Some(20_000));
        assert_eq!(cli("19.76").map(|cli| cli.period).ok(), Some(Limits::APPENDIX));
        assert!(Cli::try_parse_from(["rcs-cell", "--link", "x"]).is_ok_and(|cli| cli.period == Limits::NBS));
        for wrong in ["0", "15", "1010", "fast"] {
            assert_eq!(cli(wrong).expect_err(wrong).exit_code(), 2);
        }
        assert!(Cli::try_parse_from(["rcs-cell"]).is_err());
    }
}
