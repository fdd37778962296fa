//! The configuration of a run.

use std::{collections::BTreeMap, fmt, path::PathBuf, str::FromStr, sync::Arc, sync::atomic::AtomicBool};

use depc::{
    host::RESTART_TICKS,
    track::{LAG_MS, MOST_LAG_MS},
};
use executive::egm::{EgmOptions, Peer};
use executive::{
    memory::{OnTimeout, RunName},
    overrun::Policy,
    serial::SerialSettings,
};
use record::LogLimit;
use serde::{Deserialize, Serialize};
use sessions::live::Origin;
use sessions::network::{Address, Role};

use crate::as_text;

/// Largest number of ticks in 40 ms: a tick with the simulated cell takes about 0.2 ms.
pub const MOST_SPEED: u8 = 20;

/// [`RunConfig::default`] is `rcs-run` without options. Serde reads and writes it with the words of the command line,
/// such as `robot = "egm:6510,slack=15"` in TOML; an omitted field has the default, an unknown field is an error.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct RunConfig {
    pub data: PathBuf,
    /// Name of a job in the data directory, or a path. Unused if another process commands.
    pub job: String,
    /// Ticks as fast as possible, or one every 40 ms.
    pub clock: ClockKind,
    /// Number of ticks in 40 ms with the real clock; more than 1 needs the simulated robot.
    pub speed: u8,
    #[serde(with = "as_text")]
    pub overrun: Policy,
    /// CPU core for the real clock; `None` for the highest core that the process may use.
    pub cpu: Option<usize>,
    #[serde(with = "as_text")]
    pub robot: RobotConfig,
    /// Couplers between the controller and the devices of the cell, if any.
    #[serde(with = "as_text::option")]
    pub field: Option<FieldConfig>,
    /// File with faults of the cell and of the line to the simulated robot.
    pub faults: Option<PathBuf>,
    /// Distribution of the control processes over boards.
    pub boards: Boards,
    /// The program that runs a board, with the arguments of `rcs-run board`.
    pub program: PathBuf,
    /// Name of the run in shared memory; `None` for job name and process number.
    #[serde(with = "as_text::option")]
    pub name: Option<RunName>,
    /// Time limit, s, for boards that are started by hand, for neighbours, and for a robot controller at a port.
    pub wait: u32,
    /// Seed of the cell's sensor noise and of the positions of delivered parts.
    pub seed: u64,
    #[serde(with = "as_text")]
    pub log: LogTarget,
    /// Size after which the run begins a new log, and number of logs that are kept; `None` for one log.
    #[serde(skip)]
    pub log_limit: Option<LogLimit>,
    /// File in which the run keeps what the controller knows, for a start after a loss of power (docs/resume.md).
    pub journal: Option<PathBuf>,
    /// Journal or log of an earlier run: the controller starts with its knowledge, and the job waits for an operator.
    /// The run continues a journal, unless [`Self::journal`] names another file.
    pub resume: Option<PathBuf>,
    /// SQLite file of the Data System's items. Without it they are in memory and lost at the end.
    #[serde(alias = "data-base")]
    pub database: Option<PathBuf>,
    /// Address at which neighbours in other processes connect.
    #[serde(with = "as_text::option")]
    pub network: Option<Address>,
    #[serde(with = "as_text::list")]
    pub outside: Vec<Role>,
    /// Begin under stand-alone command, with the job, although the workstation controller is another process (IV.4.1).
    pub stand_alone: bool,
    /// File that keeps updates until a Data System in another process receives them.
    pub outbox: PathBuf,
    /// Stop after this number of ticks, unless the job ends before.
    pub ticks: Option<u64>,
    /// Greatest number of times, per line of the job, that PAUSE and the same command follow an error.
    pub retry: u32,
    pub operator: OperatorAccess,
    /// A log whose operator inputs are replayed, each in its tick. Operators cannot connect then.
    pub inputs: Option<PathBuf>,
    /// Make the job wait for an operator before its first line.
    pub stand_by: bool,
    /// Execute commands even if `check` finds errors in the records that they use.
    pub unchecked: bool,
    /// Port of 127.0.0.1 for viewers of the run, 0 for any free port; needs a log.
    pub live: Option<u16>,
    /// Origins of web pages that may connect as viewers, in addition to Foxglove's.
    #[serde(with = "as_text::list")]
    pub live_origins: Vec<Origin>,
    /// Unix socket at which `rcs-gateway page` connects to the live view.
    #[serde(with = "as_text::option")]
    pub live_socket: Option<Address>,
    pub remarks: BTreeMap<String, String>,
    pub shared_memory: bool,
    /// Called to end the process if the set-up of shared memory takes too long (`executive::memory::limit`),
    /// before the robot moves; `None` for no limit.
    #[serde(skip)]
    pub on_stuck: Option<OnTimeout>,
    /// Ends the run when it is set. The robot is first brought to rest.
    #[serde(skip)]
    pub stop: Arc<AtomicBool>,
}

impl RunConfig {
    /// The configuration for a job of a data directory in the simulated cell, as fast as possible.
    #[must_use]
    pub fn new(data: impl Into<PathBuf>, job: impl Into<String>) -> Self {
        Self {
            data: data.into(),
            job: job.into(),
            clock: ClockKind::Fast,
            speed: 1,
            overrun: Policy::Count,
            cpu: None,
            robot: RobotConfig { kind: RobotKind::Sim, silence: None, lag: None },
            field: None,
            faults: None,
            boards: Boards::One,
            program: "rcs-run".into(),
            name: None,
            wait: 300,
            seed: 1,
            log: LogTarget::Default,
            log_limit: None,
            journal: None,
            resume: None,
            database: None,
            network: None,
            outside: Vec::new(),
            stand_alone: false,
            outbox: "runs/data-system.outbox".into(),
            ticks: None,
            retry: 0,
            operator: OperatorAccess::Owner,
            inputs: None,
            stand_by: false,
            unchecked: false,
            live: None,
            live_origins: Vec::new(),
            live_socket: None,
            remarks: BTreeMap::new(),
            shared_memory: true,
            on_stuck: None,
            stop: Arc::default(),
        }
    }

    #[must_use]
    pub fn has_real_devices(&self) -> bool {
        self.field.as_ref().is_some_and(|field| !field.is_simulated)
    }

    #[must_use]
    pub fn played(&self) -> Option<&str> {
        (self.stand_alone || !self.outside.contains(&Role::Workstation)).then_some(self.job.as_str())
    }
}

impl Default for RunConfig {
    fn default() -> Self {
        Self::new("data", "linkbar")
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldConfig {
    /// Name of a mapping in the data directory, or a path.
    pub mapping: PathBuf,
    /// True for emulated couplers in simulated time; false for couplers over TCP at the addresses of the mapping.
    pub is_simulated: bool,
}

/// Prefix of a mapping whose couplers are emulated in simulated time.
const SIMULATED: &str = "sim:";

impl FieldConfig {
    /// Emulated couplers in simulated time.
    #[must_use]
    pub fn simulated(mapping: impl Into<PathBuf>) -> Self {
        Self { mapping: mapping.into(), is_simulated: true }
    }

    #[must_use]
    pub fn tcp(mapping: impl Into<PathBuf>) -> Self {
        Self { mapping: mapping.into(), is_simulated: false }
    }
}

impl fmt::Display for FieldConfig {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let prefix = if self.is_simulated { SIMULATED } else { "" };
        write!(f, "{prefix}{}", self.mapping.display())
    }
}

impl FromStr for FieldConfig {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let name = text.strip_prefix(SIMULATED);
        if name.unwrap_or(text).is_empty() {
            return Err(format!(
                "a mapping was expected: NAME or FILE for couplers over TCP, or {SIMULATED}NAME; found {text:?}"
            ));
        }
        Ok(name.map_or_else(|| Self::tcp(text), Self::simulated))
    }
}

/// Access of operators to a run (`docs/operator.md`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum OperatorAccess {
    /// Nobody
    None,
    /// Programs of the user who runs it, on this machine
    Owner,
    /// These, and operators at --network, which rcs-gateway connects with other machines; viewers with the token of --live
    Network,
}

/// When ticks are run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum ClockKind {
    /// As fast as the cell can be simulated
    Fast,
    /// On a 40 ms grid
    Real,
}

impl ClockKind {
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Real => "real",
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum RobotKind {
    /// The simulated T3.
    Sim,
    /// A robot controller at a serial port.
    Serial(SerialSettings),
    Egm(Box<EgmOptions>),
    /// A robot of the library's caller ([`Run::with_robot`](crate::Run::with_robot)).
    Own,
}

impl RobotKind {
    /// True if the robot cannot follow simulated time.
    #[must_use]
    pub fn lives_in_real_time(&self) -> bool {
        match self {
            Self::Sim | Self::Own => false,
            Self::Serial(_) => true,
            Self::Egm(options) => options.peer != Peer::Simulated,
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct RobotConfig {
    pub kind: RobotKind,
    /// Seconds for which a controller may be silent while its DTR is on; `None` for the default.
    pub silence: Option<u16>,
    /// Time by which the robot is expected to lag behind its points, ms; `None` for the robot's own value, or 200 ms.
    pub lag: Option<u16>,
}

/// Upper limit of the silence, s.
const LONGEST_SILENCE: u16 = 2600;

impl RobotConfig {
    /// Ticks for which a controller may be silent, if configured.
    #[must_use]
    pub fn silence_limit(&self) -> Option<u16> {
        self.silence.map(|seconds| seconds * RESTART_TICKS)
    }
}

impl fmt::Display for RobotConfig {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            RobotKind::Sim => f.write_str("sim"),
            RobotKind::Serial(settings) => write!(f, "serial:{settings}"),
            RobotKind::Egm(options) => options.fmt(f),
            RobotKind::Own => f.write_str("own"),
        }?;
        self.silence.map_or(Ok(()), |seconds| write!(f, ",silence={seconds}"))?;
        self.lag.map_or(Ok(()), |ms| write!(f, ",lag={ms}"))
    }
}

impl FromStr for RobotConfig {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let option = |name: &str| text.split(',').find_map(|part| part.strip_prefix(name)?.strip_prefix('='));
        let silence = option("silence").map(silence).transpose()?;
        let lag = option("lag").map(lag).transpose()?;
        let is_of_kind = |part: &&str| !(part.starts_with("silence=") || part.starts_with("lag="));
        let rest: Vec<&str> = text.split(',').filter(is_of_kind).collect();
        let rest = rest.join(",");
        let kind = match rest.split_once(':') {
            None if rest == "sim" => RobotKind::Sim,
            Some(("serial", port)) => RobotKind::Serial(port.parse()?),
            Some(("egm", robot)) => RobotKind::Egm(Box::new(robot.parse()?)),
            _ => {
                let expected = "sim[,silence=SECONDS][,lag=MS], serial:PATH[,OPTION...] or egm:[ADDRESS:]PORT[,OPTION...]";
                return Err(format!("{expected} was expected"));
            }
        };
        Ok(Self { kind, silence, lag })
    }
}

fn silence(seconds: &str) -> Result<u16, String> {
    seconds.parse().ok().filter(|seconds| (1..=LONGEST_SILENCE).contains(seconds)).ok_or_else(|| {
        format!("silence is a number of seconds from 1 to {LONGEST_SILENCE}, such as 60; found {seconds}")
    })
}

fn lag(ms: &str) -> Result<u16, String> {
    ms.parse().ok().filter(|ms| *ms <= MOST_LAG_MS).ok_or_else(|| {
        format!("lag is a number of milliseconds from 0 to {MOST_LAG_MS}, such as {LAG_MS}; found {ms}")
    })
}

/// Distribution of the control processes over boards.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Boards {
    /// All in one thread
    One,
    /// One operating system process per board: 0 (this one), 2, 4, 6, 8
    Split,
    /// As split, but you start the boards, with rcs-run board
    Manual,
}

impl Boards {
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::One => "one",
            Self::Split => "split",
            Self::Manual => "manual",
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LogTarget {
    /// `runs/JOB.mcap`, or the next free name.
    Default,
    None,
    File(PathBuf),
}

impl fmt::Display for LogTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Default => f.write_str("default"),
            Self::None => f.write_str("none"),
            Self::File(path) => path.display().fmt(f),
        }
    }
}

impl FromStr for LogTarget {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "" => Err("a file name or none was expected".into()),
            "default" => Ok(Self::Default),
            "none" | "/dev/null" => Ok(Self::None),
            "off" => {
                Err("a file name, or none for no log, was expected; for a file with this name write ./off"
                    .into())
            }
            path => Ok(Self::File(path.into())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn log_target_parses_from_text() {
        assert_eq!("none".parse(), Ok(LogTarget::None));
        assert_eq!("run.mcap".parse(), Ok(LogTarget::File("run.mcap".into())));
        let error = "off".parse::<LogTarget>().expect_err("most likely a mistake for none");
        assert!(error.contains("none for no log"), "{error}");
        assert_eq!("./off".parse(), Ok(LogTarget::File("./off".into())));
    }

    #[test]
    fn robot_parses_from_text() {
        let robot = |text: &str| text.parse::<RobotConfig>();
        assert_eq!(robot("sim").ok(), Some(RobotConfig { kind: RobotKind::Sim, silence: None, lag: None }));
        let kind = RobotKind::Serial(SerialSettings::new("/dev/ttyS0"));
        let port = RobotConfig { kind, silence: None, lag: None };
        assert_eq!((robot("serial:/dev/ttyS0").ok(), port.silence_limit()), (Some(port.clone()), None));
        let patient = RobotConfig { silence: Some(90), ..port };
        assert_eq!(robot("serial:/dev/ttyS0,silence=90,stop=1").ok(), Some(patient.clone()));
        assert_eq!(patient.silence_limit(), Some(90 * 25));
        let both = robot("sim,lag=300,silence=5").map(|robot| robot.to_string());
        assert_eq!(both, Ok("sim,silence=5,lag=300".into()));
        assert!(robot("sim,lag=1001").is_err() && robot("egm:sim,lag=x").is_err());
        assert_eq!(robot("sim,silence=5").ok().and_then(|robot| robot.silence_limit()), Some(125));
        for wrong in [
            "serial",
            "serial:",
            "serial:/dev/x,stop=3",
            "/dev/ttyS0",
            "sim,stop=1",
            "sim,silence=0",
            "sim,silence=2601",
        ] {
            assert!(robot(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn configuration_round_trips_with_defaults() {
        let config = RunConfig {
            overrun: Policy::Hold(3),
            robot: "serial:/dev/ttyS0,parity=even,silence=90".parse().unwrap(),
            boards: Boards::Split,
            name: Some("cell-1".parse().unwrap()),
            log: LogTarget::None,
            network: Some("unix:/run/t3.sock".parse().unwrap()),
            outside: vec![Role::Workstation, Role::DataSystem],
            ticks: Some(50),
            live: Some(0),
            live_origins: vec!["http://localhost:8080".parse().unwrap()],
            live_socket: Some("unix:/run/t3-live.sock".parse().unwrap()),
            ..RunConfig::new("cell", "clevis")
        };
        let text = toml::to_string(&config).unwrap();
        let again: RunConfig = toml::from_str(&text).unwrap();
        assert_eq!(format!("{config:?}"), format!("{again:?}"), "{text}");
        let some: RunConfig = toml::from_str("job = \"clevis\"\nrobot = \"egm:sim,loss=20\"").unwrap();
        let expected =
            RunConfig { robot: "egm:sim,loss=20".parse().unwrap(), ..RunConfig::new("data", "clevis") };
        assert_eq!(format!("{some:?}"), format!("{expected:?}"));
        let wrong = |text: &str| toml::from_str::<RunConfig>(text).unwrap_err().to_string();
        assert!(wrong("jobs = \"clevis\"").contains("unknown field `jobs`"));
        assert!(wrong("overrun = \"hold:0\"").contains("SLOTS from 1"));
        assert!(wrong("outside = [\"printer\"]").contains("printer"));
    }
}
