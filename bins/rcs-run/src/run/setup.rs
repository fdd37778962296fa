//! Everything that must be there before the first tick.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::{Arc, atomic::AtomicBool},
};

use depc::fault::Injector;
use executive::serial::SerialLine;
use neighbours::{
    data_system::{self, ANSWER_TICKS, Agent, DataSystem, Outbox, Pace},
    network::{Desk, Listener, Role, Secret, hello},
    pedestal, vision,
    workstation::player::{Hwsc, TIME_LIMIT},
};
use os_io::files;
use plant::{
    Cell, CellDescription,
    camera::Analysis,
    fault::text::{self, FaultFile},
};
use record::LogFile;
use taskdata::load::{Diagnostics, Job, Source, Store};

use super::{
    neighbours::{Emulator, Neighbours, Network, WorkstationSource},
    robot::{Port, Robot},
    switched::Switched,
};
use crate::{
    agreement, check,
    cli::{ClockKind, LogTarget, RobotKind, RunArguments},
    error::Error,
};

/// Directory of the jobs in the data directory.
pub const JOBS: &str = "jobs";
/// Extension of job files.
pub const EXTENSION: &str = "job";
/// The cell description in the data directory.
pub const CELL: &str = "cell.toml";

/// What a run works with.
pub struct Setup {
    /// Task data.
    pub store: Store,
    /// The job.
    pub job: Job,
    /// The cell description as written.
    pub description_text: String,
    /// The cell description.
    pub description: CellDescription,
    /// The cell.
    pub cell: Cell,
    /// The file of faults as written; empty without one.
    pub faults_text: String,
    /// The other end of the line.
    pub robot: Robot,
    /// Who commands, and the Data System.
    pub neighbours: Neighbours,
    /// Where the log goes.
    pub log: Option<LogFile>,
}

impl Setup {
    /// Read, check and build everything. Once `interrupted` is set the run ends.
    ///
    /// # Errors
    /// [`Error`], with all errors of the data.
    pub fn load(arguments: &RunArguments, interrupted: &Arc<AtomicBool>) -> Result<Self, Error> {
        if arguments.robot.kind != RobotKind::Sim && arguments.clock != ClockKind::Real {
            return Err(Error::NotInRealTime);
        }
        let data = &arguments.data;
        let TaskFiles { store, job, job_path, warnings } = TaskFiles::load(data, arguments.played())?;
        let CellFile { text: description_text, description, warning } =
            CellFile::load(data, &store, &job, &job_path)?;
        warnings.into_iter().chain(warning).for_each(|line| os_io::stderr_line!("rcs-run: {line}"));
        let (faults, faults_text) = faults(arguments, &description)?;
        let cell = Cell::with_faults(&description, arguments.seed, &faults.cell)?;
        let sees_elsewhere = arguments.outside.contains(&Role::Vision);
        let cell = if sees_elsewhere { cell.with_vision_elsewhere() } else { cell };
        let log = match &arguments.log {
            Some(LogTarget::None) => None,
            Some(LogTarget::File(path)) => Some(LogFile::claim(path)?),
            None => Some(LogFile::claim_free(Path::new("runs"), &job.name)?),
        };
        let neighbours = neighbours(arguments, &job, &description, interrupted)?;
        // The last of all: a robot hears nothing of a run that cannot begin.
        let robot = match &arguments.robot.kind {
            RobotKind::Sim => Robot::Simulated(faults.line.map(|plan| Box::new(Injector::new(&plan)))),
            RobotKind::Serial(settings) => Robot::Serial(Port::new(SerialLine::open(settings.clone())?)),
        };
        Ok(Self { store, job, description_text, description, cell, faults_text, robot, neighbours, log })
    }
}

/// What the control processes work with, on every board.
pub struct TaskFiles {
    /// Task data.
    pub store: Store,
    /// The job, with the task data that it loads on the way.
    pub job: Job,
    /// Its file; empty without one.
    pub job_path: PathBuf,
    /// Lines that say that there are warnings.
    pub warnings: Vec<String>,
}

impl TaskFiles {
    /// Read and check task data and job; without one it has no steps: another process commands.
    ///
    /// # Errors
    /// [`Error`], with all errors of the data.
    pub fn load(data: &Path, job: Option<&str>) -> Result<Self, Error> {
        if !data.is_dir() {
            return Err(Error::NoData(data.to_owned()));
        }
        let unusable = |what: String| move |report| Error::Data { what, report };
        let (store, in_data) =
            Store::load(data).map_err(unusable(format!("the task data under {}", data.display())))?;
        let job_path = job.map(|job| job_path(job, data)).transpose()?.unwrap_or_default();
        let read = match job {
            Some(_) => Job::load(&job_path, &store),
            None => {
                let name = format!("{}.{EXTENSION}", Role::Workstation);
                Job::from_source(Source { name, text: "".into() }, &store)
            }
        };
        let (job, in_job) = read.map_err(unusable(format!("the job {}", job_path.display())))?;
        let warnings = [warning(&in_data, "the task data"), warning(&in_job, "the job")];
        Ok(Self { store, job, job_path, warnings: warnings.into_iter().flatten().collect() })
    }
}

/// The cell description of a data directory.
pub struct CellFile {
    /// As written.
    pub text: String,
    /// As read.
    pub description: CellDescription,
    /// A line that says that there are warnings.
    pub warning: Option<String>,
}

impl CellFile {
    /// Read the description, and check that task data, job and description mean the same cell.
    ///
    /// # Errors
    /// [`Error`], with all errors of the data.
    pub fn load(data: &Path, store: &Store, job: &Job, job_path: &Path) -> Result<Self, Error> {
        let path = data.join(CELL);
        let text = files::read_text(&path).map_err(|source| Error::Read { path: path.clone(), source })?;
        let description = CellDescription::from_toml(&text).map_err(|error| Error::Data {
            what: format!("the cell description {}", path.display()),
            report: Box::new(check::cell_report(text.clone(), &error)),
        })?;
        let report = agreement::of_cell(check::source(text.clone()), &description, store)
            .with(agreement::of_job(job, &description, store, &path));
        if report.has_errors() {
            let what = format!("the job {} in the cell of {}", job_path.display(), path.display());
            return Err(Error::Data { what, report: Box::new(report) });
        }
        let warning = warning(&report, "the cell description");
        Ok(Self { text, description, warning })
    }
}

/// Who is in this process, and where the others can connect.
fn neighbours(
    arguments: &RunArguments,
    job: &Job,
    description: &CellDescription,
    interrupted: &Arc<AtomicBool>,
) -> Result<Neighbours, Error> {
    let (clock, pace) = match arguments.clock {
        ClockKind::Fast => (hello::ClockKind::Fast, Pace::Wait),
        ClockKind::Real => (hello::ClockKind::Real, Pace::Poll),
    };
    let desk = |role: Role| {
        let desk = || Desk::new(role, clock).until(Arc::clone(interrupted));
        arguments.outside.contains(&role).then(desk)
    };
    let (commands, items) = (desk(Role::Workstation), desk(Role::DataSystem));
    let (regrips, sees) = (desk(Role::Pedestal), desk(Role::Vision));
    let secret = arguments.secret.as_deref().map(Secret::load).transpose()?;
    let network = match &arguments.network {
        Some(address) => {
            let desks = || commands.iter().chain(&items).chain(&regrips).chain(&sees);
            let address = address.clone().configured(arguments.zenoh_config.clone())?;
            let listener = Listener::start(&address, secret, desks())?;
            os_io::stderr_line!("rcs-run: neighbours can connect at {}", listener.address());
            Some(Network { counters: desks().map(Desk::counter).collect(), _listener: listener })
        }
        None => None,
    };
    let data_system = match items {
        Some(desk) => DataSystem::elsewhere(Agent::new(desk, outbox(arguments)?), pace),
        None => {
            let file = arguments.data_base.as_deref();
            let items = file.map_or_else(data_system::Store::in_memory, data_system::Store::open)?;
            DataSystem::new(items, ANSWER_TICKS, pace)
        }
    };
    let hwsc = Hwsc::new(job.steps.clone(), TIME_LIMIT).with_retries(arguments.retry);
    let workstation = match commands {
        Some(desk) if arguments.stand_alone => {
            WorkstationSource::Switched(Box::new(Switched::new(hwsc, desk, arguments.wait)))
        }
        Some(desk) => WorkstationSource::outside(desk),
        None => WorkstationSource::Emulator(Box::new(Emulator::new(hwsc))),
    };
    let pedestal = regrips.map(|desk| Box::new(pedestal::Agent::new(desk)));
    let vision = sees.map(|desk| vision::Port::new(desk, arguments.seed, Analysis::fingerprint(description)));
    Ok(Neighbours::new(workstation, data_system, pedestal, vision, network))
}

/// Where updates wait for a Data System in another process.
fn outbox(arguments: &RunArguments) -> Result<Outbox, Error> {
    if arguments.data_base.is_some() {
        return Err(Error::DataBaseElsewhere);
    }
    let file = &arguments.outbox;
    if let Some(directory) = file.parent().filter(|path| !path.as_os_str().is_empty()) {
        fs::create_dir_all(directory).map_err(|source| Error::Read { path: directory.to_owned(), source })?;
    }
    Ok(Outbox::open(file)?)
}

/// The faults of `--faults`, none without it, with their text.
fn faults(arguments: &RunArguments, cell: &CellDescription) -> Result<(FaultFile, String), Error> {
    let Some(path) = &arguments.faults else { return Ok(Default::default()) };
    let text = files::read_text(path).map_err(|source| Error::Read { path: path.clone(), source })?;
    let faults = text::parse(&path.display().to_string(), &text, cell)?;
    if arguments.robot.kind != RobotKind::Sim && faults.line.is_some() {
        return Err(Error::FaultsAtPort);
    }
    Ok((faults, text))
}

/// Warnings do not keep a run from beginning; one line says that there are some.
fn warning(report: &Diagnostics, what: &str) -> Option<String> {
    match report.warnings().count() {
        0 => None,
        1 => Some(format!("1 warning in {what}; rcs-run check shows it")),
        count => Some(format!("{count} warnings in {what}; rcs-run check shows them")),
    }
}

/// The file of a job: a path if it looks like one or is one, else a name in the data directory.
pub fn job_path(job: &str, data: &Path) -> Result<PathBuf, Error> {
    let path = PathBuf::from(job);
    let named = data.join(JOBS).join(job).with_added_extension(EXTENSION);
    if named.is_file() {
        return Ok(named);
    }
    if path.is_file() {
        return Ok(path);
    }
    let known = check::jobs(data);
    let known =
        known.iter().filter_map(|path| path.file_stem()).map(|name| name.to_string_lossy().into_owned());
    Err(Error::NoJob { job: job.to_owned(), known: known.collect() })
}
