//! The command line.

use std::{
    path::{Path, PathBuf},
    str::FromStr,
};

use crate::{campaign::CampaignArguments, new::NewArguments};
use clap::{Args, Parser, Subcommand, ValueEnum, builder::ArgPredicate};
use cli_pages::shipped_path;
use executive::{boards::Board, memory::RunName, overrun::Policy};
use live::Origin;
use neighbours::network::{Address, Role};
use rcs_core::name::Name10;
use runtime::{Boards, ClockKind, LogTarget, OperatorAccess, RobotConfig, RunConfig, setup::MOST_SPEED};

/// The RCS-II/T3 controller: runs jobs in the simulated cell, with a robot at a serial port, or with one by EGM.
#[derive(Debug, Parser)]
#[command(
    name = "rcs-run",
    version,
    about,
    args_conflicts_with_subcommands = true,
    after_help = "\
Examples:
  rcs-run                              run the linkbar as fast as the cell can be simulated
  rcs-run linkbar --clock real         the same, one tick every 40 ms
  rcs-run my.job --seed 7 --json       a job file, other noise, the result as JSON
  rcs-run --faults data/faults/air-lost.toml
                                       the air fails in the middle of the job
  rcs-run --boards split               one operating system process a board; the same result, to the bit
  rcs-run link-test --robot serial:/dev/ttyUSB0
                                       try the line to a robot; nothing moves
  rcs-run --robot serial:/dev/ttyUSB0 --clock real
                                       command the robot there; gripper, tray, vise and camera are simulated
  rcs-run check                        look at the task data without running anything
  rcs-run check --explain 'MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0'
                                       the whole way of a command, and how long it takes
  rcs-run --network unix:/tmp/rcs.sock --outside workstation --clock real
                                       take commands from a workstation controller in another process
  rcs-run new part HINGE --size 3x1.5x1 --like LCLEVIS
                                       data for a part of another size, tried before they are shown
  rcs-run status                       what the run in the other terminal is doing
  rcs-run tables > tables.md           all decision tables

Exit status: 0 finished; 1 the job failed; 2 usage, configuration or data error;
3 stopped by an emergency stop or a lost link, or no link to test. The reason is the last line on standard error."
)]
pub struct Cli {
    /// What to do; without it, run a job.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Arguments of `run`, which may be left out.
    #[command(flatten)]
    pub run: RunArguments,
}

/// What else to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a job (the same as without a subcommand)
    Run(Box<RunArguments>),
    /// Exchange frames with a robot at a serial port, holding the position that it reports, and judge the link
    LinkTest(LinkTestArguments),
    /// Run one board of a run that was started with --boards manual
    Board(BoardArguments),
    /// Load task data, jobs and the cell description, and print all errors and warnings, and what was loaded
    Check(CheckArguments),
    /// Print every decision table as Markdown
    Tables,
    /// Measure how late this machine wakes a thread that sleeps on the 40 ms grid, with a verdict
    Latency(LatencyArguments),
    /// Print what a run that goes on is doing: each process with its command, its status, and the row that fired
    Status(StatusArguments),
    /// Ask something of a run that goes on, as an operator: a stop, a command, a line for the cell
    Send(SendArguments),
    /// Interrupt a job at many ticks, let an operator recover it, and judge what became of each branch
    Campaign(CampaignArguments),
    /// Print the nine numbers of a pose, whether the arm can take it, and write its form
    Pose(PoseArguments),
    /// Write the data that comes with the program into DIR/data, to be changed
    Init(InitArguments),
    /// Make task data and cell entries for a new part, tool, place or tray, try them, and show or write what changes
    New(NewArguments),
    /// Remove what killed runs left in shared memory
    Clean,
}

/// Arguments of `run`.
#[derive(Clone, Debug, Args)]
pub struct RunArguments {
    /// Name of a job in the data directory, or a path
    #[arg(default_value = "linkbar")]
    pub job: String,
    /// Task data, jobs and cell description
    #[arg(long, value_name = "DIR", default_value = "data", value_parser = shipped_path())]
    pub data: PathBuf,
    /// Run ticks at once: fast; one every 40 ms: real; or N in that time, with the simulated robot: Nx, such as 5x
    #[arg(
        long,
        value_name = "CLOCK",
        default_value = "fast",
        default_value_if("console", ArgPredicate::IsPresent, "real")
    )]
    pub clock: Clock,
    /// What to do about slots of the 40 ms grid that are skipped: count, hold, hold:SLOTS, stop or
    /// stop:SLOTS
    ///
    /// hold: if SLOTS (1) are skipped in a row, the robot ramps down and holds until 25 ticks were punctual;
    /// stop: it ramps down, and the run ends with exit status 3.
    #[arg(long, value_name = "POLICY", default_value_t = Policy::Count)]
    pub overrun: Policy,
    /// The core to run on with --clock real [default: the highest that is allowed]
    #[arg(long, value_name = "N")]
    pub cpu: Option<usize>,
    /// The robot to command: sim, the simulated one, serial:PATH[,OPTION...], one at a serial port, or
    /// egm:PORT or egm:ADDRESS:PORT, one of ABB that sends EGM to this UDP port
    ///
    /// Options: silence=SECONDS (60), how long to wait for a robot controller that does not answer although
    /// its DTR is on; for a port also baud=N (9600), parity=none|even|odd (none), stop=1|2 (1),
    /// cts=watch|ignore (watch; ignore is for cables of three wires). A robot at a port needs --clock real.
    ///
    /// Options of EGM: robot=NAME|FILE, its frames (data/robots/NAME.toml); from=ADDRESS, only datagrams from
    /// there count; speed-ref=on|off (on); slack=MS (10), by how much a tick may be late. egm:sim[,OPTION...] is an
    /// emulated robot in simulated time; docs/egm.md has its options.
    #[arg(long, value_name = "ROBOT", default_value = "sim")]
    pub robot: RobotConfig,
    /// Faults of the cell and of the line to the simulated robot, on schedule or by chance (TOML; data/README.md)
    #[arg(long, value_name = "FILE", value_parser = shipped_path())]
    pub faults: Option<PathBuf>,
    /// How the control processes are spread over boards
    #[arg(long, value_enum, default_value_t = Boards::One)]
    pub boards: Boards,
    /// Name of the run in shared memory [default: JOB-PID, PID the number of this process]
    #[arg(long, value_name = "NAME")]
    pub run: Option<RunName>,
    /// How many seconds to wait for boards that are started by hand, and for neighbours in other processes
    #[arg(long, value_name = "N", default_value_t = 300, value_parser = clap::value_parser!(u32).range(1..=86_400))]
    pub wait: u32,
    /// Seed of the cell's noise and of where parts are delivered
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Where to write the log; none for no log [default: runs/JOB.mcap]
    #[arg(long, value_name = "FILE")]
    pub log: Option<LogTarget>,
    /// Keep the items of the Data System in this SQLite file, which is made if it is not there [default: forget them]
    #[arg(long, value_name = "FILE")]
    pub data_base: Option<PathBuf>,
    /// Let neighbours in other processes, and operators of --operator network, connect here: unix:PATH, or with --keys
    /// tcp:IP:PORT, zenoh:NAME or zenoh:NAME@ENDPOINT (docs/neighbours.md)
    #[arg(long, value_name = "ADDRESS")]
    pub network: Option<Address>,
    /// Neighbours that are other processes, with commas between them: workstation, data-system, pedestal, vision
    #[arg(long, value_name = "NEIGHBOURS", value_delimiter = ',', requires = "network")]
    pub outside: Vec<Role>,
    /// Begin under stand-alone command: play the job; its lines `** workstation` hand over to the workstation
    /// controller until it disconnects (IV.4.1)
    #[arg(long, requires = "outside")]
    pub stand_alone: bool,
    /// File in which updates wait for a Data System in another process
    #[arg(long, value_name = "FILE", default_value = "runs/data-system.outbox")]
    pub outbox: PathBuf,
    /// Directory with keys and certificates for neighbours on other machines, as `rcs-neighbour keys` makes it
    #[arg(long, value_name = "DIR", requires = "network")]
    pub keys: Option<PathBuf>,
    /// File with Zenoh's own configuration (JSON5): TLS, access control, routers
    #[arg(long, value_name = "FILE", requires = "network")]
    pub zenoh_config: Option<PathBuf>,
    /// Stop after so many ticks if the job is not over before
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub ticks: Option<u64>,
    /// After a command that ends with an error send PAUSE and the same command again, at most so many times a line
    ///
    /// Errors that need a person are not retried (docs/reasons.md). Actions `** after` of the line are not begun again.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub retry: u32,
    /// Who may operate the run while it goes on, by rcs-console --operate, rcs-run send or a viewer of --live; needs
    /// --clock real
    #[arg(long, value_enum, default_value_t = OperatorAccess::Owner)]
    pub operator: OperatorAccess,
    /// Show the operator's console on this terminal; with the real clock unless --clock says otherwise
    ///
    /// When you leave it the robot ramps to rest and the run ends.
    #[arg(long, conflicts_with_all = ["json", "inputs"])]
    pub console: bool,
    /// Wait for an operator before the first line of the job
    #[arg(long)]
    pub stand_by: bool,
    /// Give the operator's inputs of this log again, each in its tick
    #[arg(long, value_name = "LOG")]
    pub inputs: Option<PathBuf>,
    /// Show the run to Foxglove or Lichtblick on this machine, at ws://127.0.0.1:PORT [default port: 8765]
    ///
    /// The view gets what the log gets, so that it needs one (docs/live.md). People need --clock real, or 5x.
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = "8765", value_parser = port)]
    pub live: Option<u16>,
    /// Let pages of this site connect to the live view, such as http://localhost:8080; may be given again
    #[arg(long, value_name = "ORIGIN", requires = "live")]
    pub live_origin: Vec<Origin>,
    /// Show the buffers to other programs
    #[arg(long, value_enum, default_value_t = Switch::On)]
    pub shared_memory: Switch,
    /// Print one JSON object on standard output at the end, and nothing else there
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `board`.
#[derive(Clone, Debug, Args)]
pub struct BoardArguments {
    /// Number of the board: 2 (E-move, Prim), 4 (T3 Interface), 6 (Task, Subtask), 8 (Quick Change, grippers, pedestal)
    #[arg(value_name = "BOARD")]
    pub board: Board,
    /// The job of the run: name in the data directory, or a path
    #[arg(default_value = "linkbar")]
    pub job: String,
    /// The run has no job: a workstation controller in another process commands
    #[arg(long, conflicts_with = "job")]
    pub commanded: bool,
    /// Name of the run, as rcs-run says it
    #[arg(long, value_name = "NAME")]
    pub run: RunName,
    /// Task data and jobs; they must be those of the run
    #[arg(long, value_name = "DIR", default_value = "data", value_parser = shipped_path())]
    pub data: PathBuf,
    /// The core to run on if ticks come every 40 ms [default: the highest that is allowed]
    #[arg(long, value_name = "N")]
    pub cpu: Option<usize>,
    /// End with this process, which has started the board
    #[arg(long, value_name = "PROCESS", hide = true)]
    pub parent: Option<u32>,
}

impl RunArguments {
    /// What to run.
    #[must_use]
    pub fn config(&self) -> RunConfig {
        let own = self.clone();
        RunConfig {
            clock: own.clock.kind,
            speed: own.clock.speed,
            overrun: own.overrun,
            cpu: own.cpu,
            robot: own.robot,
            faults: own.faults,
            boards: own.boards,
            name: own.run,
            wait: own.wait,
            seed: own.seed,
            log: own.log.unwrap_or(LogTarget::Default),
            data_base: own.data_base,
            network: own.network,
            outside: own.outside,
            stand_alone: own.stand_alone,
            outbox: own.outbox,
            keys: own.keys,
            zenoh_config: own.zenoh_config,
            ticks: own.ticks,
            retry: own.retry,
            operator: own.operator,
            inputs: own.inputs,
            stand_by: own.stand_by,
            live: own.live,
            live_origins: own.live_origin,
            shared_memory: own.shared_memory == Switch::On,
            ..RunConfig::new(own.data, own.job)
        }
    }
}

impl CheckArguments {
    /// To look at a data directory, and nothing else.
    #[must_use]
    pub fn of(data: &Path) -> Self {
        Self {
            data: data.to_owned(),
            directory: None,
            json: false,
            urdf: None,
            explain: None,
            explain_job: None,
            place: None,
            from: "HOME".to_owned(),
            robot: None,
        }
    }
}

impl BoardArguments {
    /// The job that is played; `None` if another process commands.
    #[must_use]
    pub fn played(&self) -> Option<&str> {
        (!self.commanded).then_some(self.job.as_str())
    }
}

/// Arguments of `link-test`.
#[derive(Clone, Debug, Args)]
pub struct LinkTestArguments {
    /// The robot: serial:PATH[,OPTION...], with the options of a run
    #[arg(long, value_name = "ROBOT")]
    pub robot: RobotConfig,
    /// How long to try
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=86_400))]
    pub seconds: u32,
    /// Print every frame in hexadecimal with direction and time (with --json on standard error)
    #[arg(long)]
    pub dump: bool,
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `latency`.
#[derive(Clone, Debug, Args)]
pub struct LatencyArguments {
    /// How long to measure
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=86_400))]
    pub seconds: u32,
    /// The core to measure [default: the highest that is allowed]
    #[arg(long, value_name = "N")]
    pub cpu: Option<usize>,
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `status`.
#[derive(Clone, Debug, Args)]
pub struct StatusArguments {
    /// Name of the run; may be left out if there is only one
    #[arg(value_name = "RUN")]
    pub run: Option<RunName>,
    /// Print the directory in which the tool iox2 of iceoryx2 finds the run, and nothing else
    #[arg(long, conflicts_with = "json")]
    pub directory: bool,
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `send`.
#[derive(Clone, Debug, Args)]
pub struct SendArguments {
    /// What to ask for, such as `stop`, `PAUSE`, `job go`, `vise open PFIXTURE` (docs/operator.md); several lines are
    /// asked for one after the other, up to the first that is refused
    #[arg(value_name = "LINE", required = true)]
    pub lines: Vec<String>,
    /// Name of the run; may be left out if there is only one
    #[arg(long, value_name = "NAME")]
    pub run: Option<RunName>,
    /// Ask a run with --operator network, here or on another machine: the address of its --network
    #[arg(long, value_name = "ADDRESS", conflicts_with = "run")]
    pub connect: Option<Address>,
    /// Directory with ca.pem, operator.pem and operator.key for tcp: and zenoh:, as `rcs-neighbour keys` makes them
    #[arg(long, value_name = "DIR", requires = "connect")]
    pub keys: Option<PathBuf>,
    /// File with Zenoh's own configuration (JSON5): TLS, access control, routers
    #[arg(long, value_name = "FILE", requires = "connect")]
    pub zenoh_config: Option<PathBuf>,
    /// Stay connected for so many seconds after the last line: what is held at the joystick box is let go at the end
    #[arg(long, value_name = "SECONDS", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=86_400))]
    pub stay: u32,
    /// Who asks, for the log
    #[arg(long, value_name = "NAME", default_value = "send")]
    pub name: operator::Name,
}

/// Arguments of `pose`.
#[derive(Clone, Debug, Args)]
#[command(allow_negative_numbers = true)]
pub struct PoseArguments {
    /// The tool point, inches; without it and without --of the pose that was recorded in a run
    #[arg(value_names = ["X", "Y", "Z"], num_args = 3)]
    pub point: Vec<f64>,
    /// Where the tool leans, degrees from the X axis of the world; the finger point lies level, 90 degrees further
    #[arg(long, value_name = "DEGREES", default_value_t = -90.0, requires = "point")]
    pub azimuth: f64,
    /// How far the tool leans from straight down, degrees
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, requires = "point")]
    pub tilt: f64,
    /// Turn of the finger point about the axis of the tool, degrees
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, requires = "point")]
    pub roll: f64,
    /// A pose of the task data
    #[arg(long, value_name = "POSE", conflicts_with = "point")]
    pub of: Option<String>,
    /// The run in which the pose was recorded; may be left out if there is only one
    #[arg(long, value_name = "NAME", conflicts_with_all = ["point", "of"])]
    pub run: Option<RunName>,
    /// Write the form into this file: in the place of the form of that name, or at the end of --block
    #[arg(long, value_name = "FILE", requires = "name")]
    pub write: Option<PathBuf>,
    /// The block of a new form
    #[arg(long, value_name = "NUMBER", requires = "write")]
    pub block: Option<u32>,
    /// Name of the pose in the form
    #[arg(long, value_name = "POSE", requires = "write")]
    pub name: Option<Name10>,
    /// Movetable of the form
    #[arg(long, value_name = "NAME", default_value = "...", requires = "write")]
    pub movetable: String,
    /// Write a movetable that leads from this pose of the task data to the one that is shown, and no pose
    #[arg(long, value_name = "POSE", requires = "write", conflicts_with = "movetable")]
    pub relative: Option<String>,
    /// Task data and cell description
    #[arg(long, value_name = "DIR", default_value = "data", value_parser = shipped_path())]
    pub data: PathBuf,
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `init`.
#[derive(Clone, Debug, Args)]
pub struct InitArguments {
    /// Directory that gets data/, such as the present one, `.`; it is made if it is not there
    #[arg(value_name = "DIR")]
    pub directory: PathBuf,
}

/// Arguments of `check`.
#[derive(Clone, Debug, Args)]
pub struct CheckArguments {
    /// Task data, jobs and cell description
    #[arg(long, value_name = "DIR", default_value = "data", value_parser = shipped_path())]
    pub data: PathBuf,
    /// The same as --data DIR
    #[arg(value_name = "DIR", conflicts_with = "data", value_parser = shipped_path())]
    pub directory: Option<PathBuf>,
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
    /// Write the cell as a URDF, for viewers and other simulators
    #[arg(long, value_name = "FILE")]
    pub urdf: Option<PathBuf>,
    /// Print the whole way of a command: the fields after == in a job
    #[arg(long, value_name = "COMMAND")]
    pub explain: Option<String>,
    /// Print the ways of all lines of a job: times, joints, closest clearances
    #[arg(long, value_name = "JOB", conflicts_with = "explain")]
    pub explain_job: Option<String>,
    /// Print the joints of a pose, the joint nearest to a limit, and what is nearest to the robot there: the same as
    /// `rcs-run pose --of NAME`
    #[arg(long = "where", value_name = "NAME", conflicts_with_all = ["explain", "explain_job", "urdf"])]
    pub place: Option<String>,
    /// Location at which the robot is taken to stand before the command
    #[arg(long, value_name = "NAME", default_value = "HOME", requires = "explain")]
    pub from: String,
    /// Tell also whether the arm of this robot reaches every taught pose and follows every way of every job: a name in
    /// data/robots, or a file, with a table `arm` (docs/egm.md)
    #[arg(long, value_name = "NAME|FILE", conflicts_with_all = ["explain", "explain_job", "place"])]
    pub robot: Option<String>,
}

/// When ticks are run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clock {
    /// Whether there is a grid.
    pub kind: ClockKind,
    /// Ticks in 40 ms.
    pub speed: u8,
}

impl FromStr for Clock {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let speed = || text.strip_suffix('x')?.parse().ok().filter(|speed| (1..=MOST_SPEED).contains(speed));
        let (kind, speed) = match text {
            "fast" => (ClockKind::Fast, 1),
            "real" => (ClockKind::Real, 1),
            _ => (
                ClockKind::Real,
                speed()
                    .ok_or_else(|| format!("fast, real or 1x to {MOST_SPEED}x was expected; found {text}"))?,
            ),
        };
        Ok(Self { kind, speed })
    }
}

/// A port of this machine.
fn port(text: &str) -> Result<u16, String> {
    text.parse()
        .map_err(|_| format!("a port from 0 to 65535 was expected, found {text}; a job stands before --live"))
}

/// Yes or no.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Switch {
    /// Yes
    On,
    /// No
    Off,
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
    fn run_may_be_left_out() {
        let short = Cli::parse_from(["rcs-run", "other", "--seed", "7", "--log", "none"]);
        assert!(short.command.is_none());
        let long = Cli::parse_from(["rcs-run", "run", "other", "--seed", "7", "--log", "none"]);
        let Some(Command::Run(long)) = long.command else { panic!("run was asked for") };
        assert_eq!((short.run.job, short.run.seed, short.run.log), (long.job, long.seed, long.log));
        assert_eq!(Cli::parse_from(["rcs-run"]).run.job, "linkbar");
    }

    #[test]
    fn a_board_is_one_that_has_processes() {
        let board = |number| {
            let command = Cli::try_parse_from(["rcs-run", "board", number, "--run", "x", "linkbar"])?.command;
            let Some(Command::Board(arguments)) = command else { panic!("board was asked for") };
            Ok::<_, clap::Error>(arguments.board)
        };
        assert_eq!(board("8").ok(), Some(Board::Eight));
        let error = board("0").expect_err("it is rcs-run itself");
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("--boards split"), "{error}");
        assert!(board("3").is_err());
    }

    #[test]
    fn the_console_is_for_eyes() {
        let clock = |words: &[&str]| Cli::parse_from(words).run.clock;
        assert_eq!(clock(&["rcs-run", "--console"]).kind, ClockKind::Real);
        assert_eq!(clock(&["rcs-run", "--console", "--clock", "5x"]).speed, 5);
        assert_eq!(clock(&["rcs-run"]).kind, ClockKind::Fast);
    }

    #[test]
    fn a_clock_has_a_speed() {
        let clock = |text| Cli::try_parse_from(["rcs-run", "--clock", text]).map(|cli| cli.run.clock);
        assert_eq!(clock("fast").ok(), Some(Clock { kind: ClockKind::Fast, speed: 1 }));
        assert_eq!(clock("real").ok(), Some(Clock { kind: ClockKind::Real, speed: 1 }));
        assert_eq!(clock("5x").ok(), Some(Clock { kind: ClockKind::Real, speed: 5 }));
        for wrong in ["0x", "21x", "x", "5", "slow"] {
            assert!(clock(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_live_view_has_a_port() {
        let live = |arguments: &[&str]| {
            let all = ["rcs-run"].iter().chain(arguments);
            Cli::try_parse_from(all).map(|cli| (cli.run.job, cli.run.live))
        };
        assert_eq!(live(&[]).ok(), Some(("linkbar".into(), None)));
        assert_eq!(live(&["shift", "--live"]).ok(), Some(("shift".into(), Some(8765))));
        assert_eq!(live(&["--live", "--clock", "real"]).ok(), Some(("linkbar".into(), Some(8765))));
        assert_eq!(live(&["--live", "9000"]).ok(), Some(("linkbar".into(), Some(9000))));
        let error = live(&["--live", "shift"]).expect_err("that is no port").to_string();
        assert!(error.contains("a job stands before --live"), "{error}");
        assert!(live(&["--live-origin", "http://localhost:80"]).is_err());
        assert!(live(&["--live", "--live-origin", "localhost"]).is_err());
    }

    #[test]
    fn what_is_done_about_skipped_slots_is_a_word() {
        let overrun = |text| Cli::try_parse_from(["rcs-run", "--overrun", text]).map(|cli| cli.run.overrun);
        assert_eq!(Cli::parse_from(["rcs-run"]).run.overrun, Policy::Count);
        assert_eq!(overrun("hold:3").ok(), Some(Policy::Hold(3)));
        let error = overrun("wait").expect_err("no such policy");
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("count, hold[:SLOTS] or stop[:SLOTS] was expected"), "{error}");
    }
}
