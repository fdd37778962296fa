//! The arguments of the subcommands, without those of `campaign` and `new`, which have theirs beside them.

use std::{
    path::{Path, PathBuf},
    time::Duration,
};

use clap::{
    Args, ValueEnum,
    builder::{ArgPredicate, StringValueParser, TypedValueParser},
};
use diagnostics::ROBOTS;
use executive::{boards::Board, memory::RunName, overrun::Policy};
use rcs_core::name::Name10;
use record::LogLimit;
use runtime::{Boards, FieldConfig, LogTarget, OperatorAccess, RobotConfig, RunConfig};
use sessions::live::Origin;
use sessions::network::{Address, Role};

use crate::{
    pages::{self, DataArgument, data_directory, default_data, fault_file, with_names},
    rcs_run::clock::Clock,
};

const MEGABYTE: u64 = 1_000_000;

/// Arguments of `run`.
#[derive(Clone, Debug, Args)]
pub struct RunArguments {
    /// Name of a job in the data directory, or a path; `rcs-run jobs` lists the names
    #[arg(default_value = "linkbar", value_parser = pages::job(), hide_possible_values = true)]
    pub job: String,
    /// Task data, jobs and cell description [default: data; if there is none: built-in, the data of the program, but
    /// not with a robot at a port]
    #[arg(long, value_name = "DIR", value_parser = data_directory())]
    pub data: Option<PathBuf>,
    /// When ticks run. fast: one after the other, without waiting; real: one every 40 ms; Nx, such as 5x: N every 40
    /// ms, with the simulated robot
    #[arg(
        long,
        value_name = "CLOCK",
        default_value = "fast",
        default_value_ifs([
            ("console", ArgPredicate::IsPresent, Some("real")),
            ("resume", ArgPredicate::IsPresent, Some("real")),
        ])
    )]
    pub clock: Clock,
    /// What to do when the host misses slots of the 40 ms grid: count, hold, hold:SLOTS, stop or stop:SLOTS
    ///
    /// count: only count them. hold: after SLOTS (1) missed in a row the robot ramps down, and holds until 25 ticks in
    /// a row were on time. stop: the robot ramps down, and the run ends with exit status 3.
    #[arg(long, value_name = "POLICY", default_value_t = Policy::Count)]
    pub overrun: Policy,
    /// CPU core to run on with --clock real [default: the highest number that this process may use]
    #[arg(long, value_name = "N")]
    pub cpu: Option<usize>,
    /// The robot to command. sim: the simulated T3; serial:PATH[,OPTION...]: a T3 controller at a serial port;
    /// egm:PORT[,OPTION...] or egm:ADDRESS:PORT[,OPTION...]: an ABB robot that sends EGM to this UDP port
    ///
    /// Options, with defaults in brackets: silence=SECONDS (60), how long to wait for a robot controller that does not
    /// answer although its DTR is on; lag=MS, the time that a robot may be behind its points (200, or what its file
    /// states). For a serial port also baud=N (9600), parity=none|even|odd (none), stop=1|2 (1), cts=watch|ignore
    /// (watch; ignore is for cables of three wires). A robot at a port needs --clock real.
    ///
    /// Options of EGM: robot=NAME|FILE, the robot's frames (data/robots/NAME.toml); from=ADDRESS, ignore datagrams from
    /// other addresses; speed-ref=on|off (on); slack=MS (10), how late a tick may be. egm:sim[,OPTION...] is an
    /// emulated robot in simulated time; docs/egm.md has its options.
    #[arg(long, value_name = "ROBOT", default_value = "sim", value_parser = robot(), hide_possible_values = true)]
    pub robot: RobotConfig,
    /// Couplers between the controller and the devices of the cell: the mapping NAME of the data directory
    /// (data/field/NAME.toml), or FILE, over TCP; sim:NAME or sim:FILE for emulated couplers in simulated time
    ///
    /// Couplers over TCP need --clock real. Outputs are safe before the first tick, at the end, and when the controller
    /// is lost (docs/field.md).
    #[arg(long, value_name = "FIELD")]
    pub field: Option<FieldConfig>,
    /// Fault plan: faults of the cell and of the line to the simulated robot, at set ticks or at random; a name in the
    /// data directory, such as air-lost for data/faults/air-lost.toml, or a file (TOML; data/README.md)
    #[arg(long, value_name = "NAME|FILE", value_parser = fault_file(), hide_possible_values = true)]
    pub faults: Option<PathBuf>,
    /// How the control processes are distributed over boards
    #[arg(long, value_enum, default_value_t = Boards::One)]
    pub boards: Boards,
    /// Name of the run in shared memory [default: JOB-PID, with the process identifier of this process]
    #[arg(long, value_name = "NAME")]
    pub run: Option<RunName>,
    /// Seconds to wait for boards that are started by hand, for neighbours in other processes, and for couplers
    #[arg(long, value_name = "N", default_value_t = 300, value_parser = clap::value_parser!(u32).range(1..=86_400))]
    pub wait: u32,
    /// Seed of the cell's sensor noise and of the positions of delivered parts
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// File to write the log into; none for no log [default: runs/JOB.mcap]
    #[arg(long, value_name = "FILE")]
    pub log: Option<LogTarget>,
    /// Begin a new log when this one has reached MB megabytes; the log before is kept under the time of its end
    ///
    /// Each log can be read and replayed without the others.
    #[arg(long, value_name = "MB", value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub log_limit: Option<u64>,
    /// Keep at most N logs before this one, also of earlier runs with the same log, and remove the oldest
    #[arg(long, value_name = "N", requires = "log_limit")]
    pub log_keep: Option<usize>,
    /// Keep what the controller knows in this file, for --resume after a loss of power (docs/resume.md)
    #[arg(long, value_name = "FILE")]
    pub journal: Option<PathBuf>,
    /// Start with what the controller knew in the run of this journal or log, and wait for `job go`
    ///
    /// Nothing moves, opens or calibrates by itself. The run continues this journal, unless --journal names another
    /// file; with a log, --journal names the journal to begin. A simulated cell continues from its last save, at most
    /// a second before.
    #[arg(long, value_name = "FILE")]
    pub resume: Option<PathBuf>,
    /// Keep the items of the Data System in this SQLite file, created if missing [default: keep them during the run
    /// only]
    #[arg(long, value_name = "FILE", alias = "data-base")]
    pub database: Option<PathBuf>,
    /// Address at which neighbours in other processes, and operators of --operator network, connect: unix:PATH
    /// (docs/neighbours.md). rcs-gateway connects it with other machines
    #[arg(long, value_name = "ADDRESS")]
    pub network: Option<Address>,
    /// Neighbours that run as other processes, separated by commas: workstation, data-system, pedestal, vision
    #[arg(long, value_name = "NEIGHBOURS", value_delimiter = ',', requires = "network")]
    pub outside: Vec<Role>,
    /// Begin under stand-alone command (IV.4.1): play the job; at each line `** workstation` the workstation controller
    /// commands until it disconnects
    #[arg(long, requires = "outside")]
    pub stand_alone: bool,
    /// File that keeps updates for a Data System in another process until it has answered them
    #[arg(long, value_name = "FILE", default_value = "runs/data-system.outbox")]
    pub outbox: PathBuf,
    /// Options that no longer exist.
    #[command(flatten)]
    pub removed: pages::RemovedTls,
    /// Stop after N ticks, unless the job ends before
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub ticks: Option<u64>,
    /// After a command that ends with an error, send PAUSE and the same command again, at most N times for a line of
    /// the job
    ///
    /// Errors that need a person are not retried (docs/reasons.md). Actions `** after` of the line are not started
    /// again.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub retry: u32,
    /// Who may operate the run, with rcs-console --operate, rcs-run send or a viewer of --live; needs --clock real
    #[arg(long, value_enum, default_value_t = OperatorAccess::Owner)]
    pub operator: OperatorAccess,
    /// Show the operator's console on this terminal; the default of --clock is then real
    ///
    /// When you quit the console, the robot ramps to rest and the run ends.
    #[arg(long, conflicts_with_all = ["json", "inputs"])]
    pub console: bool,
    /// Wait for an operator before the first line of the job; needs --clock real, and an --operator who can connect
    #[arg(long)]
    pub stand_by: bool,
    /// Execute commands also if `rcs-run check` finds errors in the data that they use
    #[arg(long)]
    pub unchecked: bool,
    /// Replay the operator's inputs of this log, each in its tick
    #[arg(long, value_name = "LOG")]
    pub inputs: Option<PathBuf>,
    /// Show the run in a browser on this machine at http://127.0.0.1:PORT, and in Foxglove or Lichtblick at
    /// ws://127.0.0.1:PORT [default port: 8765]
    ///
    /// The view shows what is written to the log, so it needs a log (docs/live.md). To watch the run, use --clock real
    /// or 5x.
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = "8765", value_parser = port)]
    pub live: Option<u16>,
    /// Open the page of the live view in a browser
    #[arg(long, requires = "live")]
    pub open: bool,
    /// Let web pages of this origin connect to the live view, such as http://localhost:8080; may be given several times
    #[arg(long, value_name = "ORIGIN", requires = "live")]
    pub live_origin: Vec<Origin>,
    /// Unix socket for rcs-gateway page, which shows the live view to persons on a network: unix:PATH
    #[arg(long, value_name = "ADDRESS", requires = "live")]
    pub live_socket: Option<Address>,
    /// Let other programs read the buffers in shared memory
    #[arg(long, value_enum, default_value_t = Switch::On)]
    pub shared_memory: Switch,
    /// Print one JSON object on standard output at the end, and nothing else there
    #[arg(long)]
    pub json: bool,
}

/// The help of `board --data`.
const BOARD_DATA: &str = "Task data and jobs; they must be those of the run [default: data; if there is none: \
                          built-in, the data of the program]";

/// Arguments of `board`.
#[derive(Clone, Debug, Args)]
#[command(mut_arg("data", |data| data.help(BOARD_DATA)))]
pub struct BoardArguments {
    /// Number of the board: 2 (E-move, Prim), 4 (T3 Interface), 6 (Task, Subtask), 8 (Quick Change, grippers, pedestal)
    #[arg(value_name = "BOARD")]
    pub board: Board,
    /// The job of the run: name in the data directory, or a path
    #[arg(default_value = "linkbar", value_parser = pages::job(), hide_possible_values = true)]
    pub job: String,
    /// The run has no job: a workstation controller in another process commands it
    #[arg(long, conflicts_with = "job")]
    pub commanded: bool,
    /// Name of the run, as rcs-run prints it
    #[arg(long, value_name = "NAME")]
    pub run: RunName,
    /// The data.
    #[command(flatten)]
    pub data: DataArgument,
    /// CPU core to run on if ticks come every 40 ms [default: the highest number that this process may use]
    #[arg(long, value_name = "N")]
    pub cpu: Option<usize>,
    /// End with this process, which has started the board
    #[arg(long, value_name = "PROCESS", hide = true)]
    pub parent: Option<u32>,
}

impl RunArguments {
    #[must_use]
    pub fn config(&self) -> RunConfig {
        let own = self.clone();
        RunConfig {
            clock: own.clock.kind,
            speed: own.clock.speed,
            overrun: own.overrun,
            cpu: own.cpu,
            robot: own.robot,
            field: own.field,
            faults: own.faults,
            boards: own.boards,
            name: own.run,
            wait: own.wait,
            seed: own.seed,
            log: own.log.unwrap_or(LogTarget::Default),
            log_limit: own
                .log_limit
                .map(|size| LogLimit { bytes: size.saturating_mul(MEGABYTE), kept: own.log_keep }),
            journal: own.journal,
            resume: own.resume,
            database: own.database,
            network: own.network,
            outside: own.outside,
            stand_alone: own.stand_alone,
            outbox: own.outbox,
            ticks: own.ticks,
            retry: own.retry,
            operator: own.operator,
            inputs: own.inputs,
            stand_by: own.stand_by,
            unchecked: own.unchecked,
            live: own.live,
            live_origins: own.live_origin,
            live_socket: own.live_socket,
            shared_memory: own.shared_memory == Switch::On,
            ..RunConfig::new(own.data.unwrap_or_else(default_data), own.job)
        }
    }
}

impl CheckArguments {
    #[must_use]
    pub fn of(data: &Path) -> Self {
        Self {
            data: data.to_owned().into(),
            directory: None,
            all: false,
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
    /// Seconds to test
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=86_400))]
    pub seconds: u32,
    /// Print every frame in hexadecimal with direction and time (with --json on standard error)
    #[arg(long)]
    pub dump: bool,
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
}

/// A mapping of the data directory.
#[derive(Clone, Debug, Args)]
pub struct MappingArgument {
    /// The mapping NAME of the data directory (data/field/NAME.toml), or FILE (docs/field.md)
    #[arg(value_name = "NAME|FILE")]
    pub mapping: PathBuf,
    /// The data.
    #[command(flatten)]
    pub data: DataArgument,
}

/// Arguments of `io-test`.
#[derive(Clone, Debug, Args)]
pub struct IoTestArguments {
    /// The mapping.
    #[command(flatten)]
    pub mapping: MappingArgument,
    /// Seconds for which the inputs are read
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=3600))]
    pub seconds: u32,
    /// Only the points whose names begin with TEXT; may be repeated
    #[arg(long, value_name = "TEXT")]
    pub points: Vec<String>,
    /// Test each input alone: a person works its sensor, and says in which state it is
    #[arg(long)]
    pub wiggle: bool,
    /// Test each output alone, after a question: it is on for a second
    #[arg(long)]
    pub outputs: bool,
    /// Measure the time from the last write to the fallback of each coupler, after a question
    #[arg(long)]
    pub watchdog: bool,
    /// Close a gripper on a part, write nothing for 10 s, and compare opening and force: grip, v, tool or pedestal
    #[arg(long, value_name = "GRIPPER")]
    pub hold: Option<String>,
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `io-release`.
#[derive(Clone, Debug, Args)]
pub struct IoReleaseArguments {
    /// The mapping.
    #[command(flatten)]
    pub mapping: MappingArgument,
}

/// Arguments of `io-calibrate`.
#[derive(Clone, Debug, Args)]
pub struct IoCalibrateArguments {
    /// The mapping.
    #[command(flatten)]
    pub mapping: MappingArgument,
    /// The input, such as grip.potentiometer
    #[arg(value_name = "POINT")]
    pub point: String,
    /// Counts of the two states [default: those of the mapping]
    #[arg(long, value_name = "COUNTS", num_args = 2)]
    pub counts: Vec<f64>,
}

/// Arguments of `latency`.
#[derive(Clone, Debug, Args)]
pub struct LatencyArguments {
    /// Seconds to measure
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=86_400))]
    pub seconds: u32,
    /// CPU core to measure [default: the highest number that this process may use]
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
    /// Requests, such as `stop`, `PAUSE`, `job go`, `vise open PFIXTURE` (docs/operator.md); they are sent one after
    /// the other, up to the first that is refused
    #[arg(value_name = "LINE", required = true)]
    pub lines: Vec<String>,
    /// Name of the run; may be left out if there is only one
    #[arg(long, value_name = "NAME")]
    pub run: Option<RunName>,
    /// Address of the --network of a run with --operator network, unix:PATH, or of `rcs-gateway connect` for a run on
    /// another machine
    #[arg(long, value_name = "ADDRESS", conflicts_with = "run")]
    pub connect: Option<Address>,
    /// Options that no longer exist.
    #[command(flatten)]
    pub removed: pages::RemovedTls,
    /// Seconds to stay connected after the last line; at the end, motion by hand ends: stick, buttons and frame of the
    /// joystick box are released
    #[arg(long, value_name = "SECONDS", default_value = "0", value_parser = seconds)]
    pub stay: Duration,
    /// Name of the operator in status and log; a number follows it if another session has it
    #[arg(long, value_name = "NAME", default_value = "send")]
    pub name: sessions::operator::Name,
}

fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse::<f64>().ok().filter(|seconds| (0.0..=86_400.0).contains(seconds));
    seconds
        .map(Duration::from_secs_f64)
        .ok_or_else(|| format!("seconds from 0 to 86400 were expected, such as 1.5; found {text}"))
}

/// Arguments of `pose`.
#[derive(Clone, Debug, Args)]
#[command(allow_negative_numbers = true)]
pub struct PoseArguments {
    /// The tool point, in the units of --units [default: the pose of --of, or the pose that was recorded in a run]
    #[arg(value_names = ["X", "Y", "Z"], num_args = 3, value_parser = pages::length)]
    pub point: Vec<f64>,
    /// Direction in which the tool leans, degrees from the X axis of the world; the finger point is horizontal, 90
    /// degrees further
    #[arg(long, value_name = "DEGREES", default_value_t = -90.0, requires = "point")]
    pub azimuth: f64,
    /// How far the tool leans from straight down, degrees
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, requires = "point")]
    pub tilt: f64,
    /// Rotation of the finger point about the axis of the tool, degrees
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, requires = "point")]
    pub roll: f64,
    /// A pose of the task data
    #[arg(long, value_name = "POSE", conflicts_with = "point")]
    pub of: Option<String>,
    /// The run in which the pose was recorded; may be left out if there is only one
    #[arg(long, value_name = "NAME", conflicts_with_all = ["point", "of"])]
    pub run: Option<RunName>,
    /// Write the form into this file: it replaces the form of that name, or is added at the end of --block
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
    /// Write no pose, but a movetable that leads from this pose of the task data to the one that is shown
    #[arg(long, value_name = "POSE", requires = "write", conflicts_with = "movetable")]
    pub relative: Option<String>,
    /// The data.
    #[command(flatten)]
    pub data: DataArgument,
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `init`.
#[derive(Clone, Debug, Args)]
pub struct InitArguments {
    /// Directory in which data/ is made, such as the present one, `.`; created if missing
    #[arg(value_name = "DIR")]
    pub directory: PathBuf,
}

/// Arguments of `check`.
#[derive(Clone, Debug, Args)]
pub struct CheckArguments {
    /// The data.
    #[command(flatten)]
    pub data: DataArgument,
    /// The same as --data DIR
    #[arg(value_name = "DIR", conflicts_with = "data", value_parser = data_directory())]
    pub directory: Option<PathBuf>,
    /// Print all findings of each datum, not only the first
    #[arg(long)]
    pub all: bool,
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
    /// Write the cell as a URDF, for viewers and other simulators
    #[arg(long, value_name = "FILE")]
    pub urdf: Option<PathBuf>,
    /// Print the whole path of a command; COMMAND is the fields after == in a job
    #[arg(long, value_name = "COMMAND")]
    pub explain: Option<String>,
    /// Print the paths of all lines of a job: times, joints, smallest clearances
    #[arg(
        long,
        value_name = "JOB",
        conflicts_with = "explain",
        value_parser = pages::job(),
        hide_possible_values = true
    )]
    pub explain_job: Option<String>,
    /// Print the joints of a pose, the joint nearest to a limit, and what is nearest to the robot there, as
    /// `rcs-run pose --of NAME` does
    #[arg(long = "where", value_name = "NAME", conflicts_with_all = ["explain", "explain_job", "urdf"])]
    pub place: Option<String>,
    /// Location of the robot before the command
    #[arg(long, value_name = "NAME", default_value = "HOME", requires = "explain")]
    pub from: String,
    /// Check also whether the arm of this robot reaches every taught pose and can follow every path of every job: a
    /// name in data/robots, or a file, with a table `arm` (docs/egm.md)
    #[arg(
        long,
        value_name = "NAME|FILE",
        conflicts_with_all = ["explain", "explain_job", "place"],
        value_parser = pages::robot(),
        hide_possible_values = true
    )]
    pub robot: Option<String>,
}

/// Arguments of `jobs`.
#[derive(Clone, Debug, Args)]
pub struct JobsArguments {
    /// The data.
    #[command(flatten)]
    pub data: DataArgument,
    /// Print one JSON object on standard output, and nothing else there
    #[arg(long)]
    pub json: bool,
}

/// A robot. Completions offer the simulated ones, and the emulated ones with the frames of each robot of the data.
fn robot() -> impl TypedValueParser<Value = RobotConfig> {
    let parser = StringValueParser::new().try_map(|text| text.parse());
    with_names(parser, || {
        let own = ["sim".to_owned(), "egm:sim".to_owned()].into_iter();
        own.chain(pages::names(&ROBOTS).iter().map(|name| format!("egm:sim,robot={name}"))).collect()
    })
}

fn port(text: &str) -> Result<u16, String> {
    text.parse()
        .map_err(|_| format!("a port from 0 to 65535 was expected, found {text}; name the job before --live"))
}

/// Yes or no.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Switch {
    /// Yes
    On,
    /// No
    Off,
}
