//! The set-up of a run before the first tick.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use closed_loop::{
    JobPlayer,
    field::{Field, SimulatedField},
};
use depc::fault::Plan;
use diagnostics::JOBS;
use executive::serial::SerialLine;
use neighbours::{
    data_system::ANSWER_TICKS,
    workstation::player::{Hwsc, PlaceInJob, TIME_LIMIT},
};
use os_io::{
    files,
    replace::{Format, check_output},
};
use plant::{
    Cell, CellDescription,
    camera::Analysis,
    description,
    fault::text::{self, FaultFile},
};
use rcs_core::tick::Tick;
use record::{LogFile, RecordError, journal::Journal};
use sessions::{
    data_system::{self, Agent, Outbox, Pace},
    network::{self, Endpoint, Role},
    pedestal, vision,
};
use taskdata::load::{Diagnostics, Fault, Job, Source, Store};

use crate::{
    agreement,
    config::{ClockKind, LogTarget, MOST_SPEED, RobotKind, RunConfig},
    egm::EgmPort,
    error::StartError,
    field::FieldPort,
    findings::Findings,
    judge::{add_paths, check_job},
    live::Live,
    neighbours::{Neighbours, WorkstationSource},
    network::Network,
    observer::Observer,
    own::{OwnPort, OwnRobot},
    result::DataResult,
    resume::{self, Resumed},
    robot::{Port, Robot},
    switched::Switched,
};

pub const EXTENSION: &str = JOBS.extension;

pub use plant::description::CELL;

pub struct Setup {
    pub store: Store,
    pub data: DataResult,
    pub job: Job,
    pub description_text: String,
    pub description: CellDescription,
    pub cell: Cell,
    pub field: Option<Couplers>,
    pub mapping_text: String,
    pub faults_text: String, // text of the fault file; empty without one
    pub line_faults: Option<Plan>,
    pub robot: Robot,
    pub neighbours: Neighbours, // the source of commands, and the Data System
    pub log: Option<LogFile>,
    pub live: Option<Live>,
    pub journal: Option<Journal>,
    pub resumed: Option<Resumed>,
}

impl Setup {
    /// Read, check and build everything. Errors: [`StartError`], with all errors of the data.
    pub fn load(
        config: &RunConfig,
        own: Option<Box<dyn OwnRobot>>,
        observer: &mut dyn Observer,
    ) -> Result<Self, StartError> {
        let is_real = config.clock == ClockKind::Real && config.speed == 1;
        if config.robot.kind.lives_in_real_time() && !is_real {
            return Err(StartError::NotInRealTime);
        }
        if config.has_real_devices() && !is_real {
            return Err(StartError::FieldNotInRealTime);
        }
        if config.speed == 0 || config.speed > MOST_SPEED {
            return Err(StartError::Speed(config.speed));
        }
        let data = &config.data;
        let is_lenient = config.stand_by;
        let mut files = TaskFiles::load(data, config.played(), is_lenient)?;
        let cell = CellFile::load(data, &mut files, is_lenient || config.unchecked)?;
        let CellFile { text: description_text, description, findings } = cell;
        let TaskFiles { mut store, mut job, left_out, .. } = files;
        let walked = (!config.unchecked).then(|| add_paths(&mut store, &mut job, &description));
        if !config.unchecked && !config.stand_by {
            check_job(&job, &store, walked.as_ref())?;
        }
        left_out.into_iter().chain(findings.lines(config.unchecked)).for_each(|line| observer.message(&line));
        let (faults, faults_text) = faults(config, &description)?;
        let resumed = Resumed::load(config)?;
        let cell = match &resumed {
            Some(resumed) => resumed.cell(&description)?,
            None => Cell::with_faults(&description, config.seed, &faults.cell)?,
        };
        let mapping = config.field.as_ref().map(|field| crate::field::load(field, data)).transpose()?;
        let (mapping, mapping_text) =
            mapping.map_or_else(Default::default, |(mapping, text)| (Some(mapping), text));
        crate::field::check_cuts(&faults.cell, config, mapping.as_ref())?;
        if let Some(mapping) = &mapping {
            crate::field::check_job(mapping, &job)?;
        }
        if config.robot.kind != RobotKind::Sim {
            crate::robot::check_panel(&job)?;
        }
        for line in mapping.iter().flat_map(|mapping| crate::field::introduction(config, mapping)) {
            observer.message(&line);
        }
        let sees_elsewhere = config.outside.contains(&Role::Vision);
        let cell = if sees_elsewhere { cell.with_vision_elsewhere() } else { cell };
        let live = Live::prepare(config)?;
        let log = match &config.log {
            LogTarget::None => None,
            LogTarget::File(path) => {
                let others = [&config.inputs, &config.database, &config.resume]
                    .into_iter()
                    .flatten()
                    .map(PathBuf::as_path);
                check_output(path, Format::Mcap, others.chain([config.outbox.as_path()]))
                    .map_err(|source| RecordError::Create { path: path.clone(), source })?;
                Some(LogFile::claim(path)?)
            }
            LogTarget::Default => Some(LogFile::claim_free(Path::new("runs"), &job.name)?),
        };
        if let (Some(log), Some(inputs)) = (&log, &config.inputs)
            && config.log_limit.is_some_and(|limit| limit.may_remove(log.path(), inputs))
        {
            return Err(StartError::InputsOfLog { inputs: inputs.clone(), log: log.path().to_owned() });
        }
        let place = resumed
            .as_ref()
            .map(|resumed| (resumed.place_with(&job, mapping.as_ref()), resumed.entry().tick));
        let neighbours = neighbours(config, &job, place, &description, observer)?;
        let field = match mapping {
            Some(mapping) if config.has_real_devices() => Some(Couplers::Tcp(FieldPort::open(mapping)?)),
            Some(mapping) => {
                let field = SimulatedField::of_cell(Arc::new(mapping), &description, &cell)?;
                Some(Couplers::Simulated(Box::new(field)))
            }
            None => None,
        };
        let identity = resume::identity(config, &store, &job, &description_text);
        if let Some(resumed) = &resumed {
            resumed.check(&identity)?;
        }
        // A log is not continued: a run that is resumed from a log writes a journal if one is named.
        let journal = config.resume.as_ref().filter(|path| !record::journal::is_log(path));
        let journal = config.journal.as_ref().or(journal);
        let mut identity = identity;
        let written = log.as_ref().and_then(|log| std::path::absolute(log.path()).ok());
        identity.extend(written.map(|path| (record::journal::LOG.to_owned(), path.display().to_string())));
        let first = resumed.as_ref().map(Resumed::first);
        let journal = journal.map(|path| Journal::start(path, &identity, first.as_ref())).transpose()?;
        // Last, so that no byte is sent to the robot if the run cannot begin.
        let robot = match &config.robot.kind {
            RobotKind::Sim => Robot::Simulated,
            RobotKind::Serial(settings) => Robot::Serial(Port::new(SerialLine::open(settings.clone())?)),
            RobotKind::Egm(options) => Robot::Egm(Box::new(EgmPort::open(options, config, observer)?)),
            RobotKind::Own => Robot::Own(OwnPort::new(own.ok_or(StartError::NoOwnRobot)?)),
        };
        // The cell description is one more file.
        let data = DataResult::new(data, store.sources().len() + 1);
        Ok(Self {
            store,
            data,
            job,
            description_text,
            description,
            cell,
            field,
            mapping_text,
            faults_text,
            line_faults: faults.line,
            robot,
            neighbours,
            log,
            live,
            journal,
            resumed,
        })
    }
}

pub enum Couplers {
    Simulated(Box<SimulatedField>),
    Tcp(FieldPort), // couplers over TCP, which may not be ready yet
}

impl Couplers {
    /// Waits until the couplers are ready. Also returns the port of couplers over TCP.
    pub fn gather(
        self,
        config: &RunConfig,
        job: &str,
        observer: &mut dyn Observer,
    ) -> Result<(Field, Option<FieldPort>), StartError> {
        match self {
            Self::Simulated(field) => Ok((Field::Simulated(*field), None)),
            Self::Tcp(mut port) => {
                let desk = port.gather(config, job, observer)?;
                Ok((Field::External(desk), Some(port)))
            }
        }
    }
}

pub struct TaskFiles {
    pub store: Store,
    pub job: Job,
    pub job_path: PathBuf,
    in_data: Diagnostics,
    in_job: Diagnostics,
    left_out: Option<String>, // the line about an omitted job with errors
}

impl TaskFiles {
    /// Task data with errors are used too: [`Store::faults`]. Without a job another process commands. If `is_lenient`,
    /// a job with errors is omitted. Errors: all of the job.
    pub fn load(data: &Path, job: Option<&str>, is_lenient: bool) -> Result<Self, StartError> {
        if !files::is_directory(data) {
            return Err(StartError::NoData(data.to_owned()));
        }
        let (store, in_data) = Store::load_with_faults(data);
        let job_path = job.map(|job| JOBS.find(Path::new(job), data)).transpose()?.unwrap_or_default();
        let without_lines = |name: String| Job::from_source(Source { name, text: "".into() }, &store);
        let what = || format!("the job {}", job_path.display());
        let mut left_out = None;
        let read = match job {
            Some(_) => Job::load(&job_path, &store).or_else(|report| {
                if !is_lenient {
                    // An error of the data is probably the cause.
                    return Err(Box::new(in_data.clone().with(*report)));
                }
                left_out = Some(format!("{} is left out: {}", what(), report.in_line()));
                without_lines(job_path.display().to_string())
            }),
            None => without_lines(format!("{}.{EXTENSION}", Role::Workstation)),
        };
        let (job, in_job) = read.map_err(|report| StartError::Data { what: what(), report })?;
        Ok(Self { store, job, job_path, in_data, in_job, left_out })
    }
}

pub struct CellFile {
    pub text: String,
    pub description: CellDescription,
    pub findings: Findings, // the findings of task data, job and description that do not prevent the run
}

impl CellFile {
    /// Checks that task data, job and description describe the same cell. Errors of a form are added to
    /// [`Store::faults`]. If `is_lenient`, errors of entries of the cell are tolerated.
    pub fn load(data: &Path, task: &mut TaskFiles, is_lenient: bool) -> Result<Self, StartError> {
        let TaskFiles { store, job, job_path, in_data, in_job, .. } = task;
        let path = data.join(CELL);
        let text =
            files::read_text(&path).map_err(|source| StartError::Read { path: path.clone(), source })?;
        let description = CellDescription::from_toml(&text).map_err(|report| StartError::Data {
            what: format!("the cell description {}", path.display()),
            report: Box::new(report),
        })?;
        let source = description::source(&text);
        let of_cell = agreement::of_cell(source.clone(), &description, store);
        let of_job = agreement::of_job(job, &source, &description, store, &path);
        let in_forms: Vec<Fault> = of_cell
            .errors()
            .filter(|error| error.block().is_some())
            .map(|error| Fault::found(error, store))
            .collect();
        let in_cell = of_cell.errors().count() - in_forms.len();
        let findings = Findings::of(in_data, in_job, &of_cell, &of_job);
        if of_job.has_errors() || in_cell > 0 && !is_lenient {
            let what = format!("the job {} in the cell of {}", job_path.display(), path.display());
            // An error of the data is probably the cause.
            let report = in_data.clone().with(of_cell).with(of_job);
            return Err(StartError::Data { what, report: Box::new(report) });
        }
        for reload in &mut job.reloads {
            reload.store.add_faults(in_forms.iter().cloned());
        }
        store.add_faults(in_forms);
        Ok(Self { text, description, findings })
    }
}

/// The neighbours in this process, and the address for those in other processes.
fn neighbours(
    config: &RunConfig,
    job: &Job,
    place: Option<((PlaceInJob, Option<String>), Tick)>,
    description: &CellDescription,
    observer: &mut dyn Observer,
) -> Result<Neighbours, StartError> {
    let (clock, pace) = match config.clock {
        ClockKind::Fast => (network::ClockKind::Fast, Pace::Wait),
        ClockKind::Real => (network::ClockKind::Real, Pace::Poll),
    };
    let endpoint = |role: Role| {
        let endpoint = || Endpoint::new(role, clock).map(|new| new.until(Arc::clone(&config.stop)));
        let endpoint = config.outside.contains(&role).then(endpoint).transpose();
        endpoint.map_err(StartError::Endpoint)
    };
    let (commands, items) = (endpoint(Role::Workstation)?, endpoint(Role::DataSystem)?);
    let (regrips, sees) = (endpoint(Role::Pedestal)?, endpoint(Role::Vision)?);
    let endpoints: Vec<_> = commands.iter().chain(&items).chain(&regrips).chain(&sees).collect();
    let network = Network::start(config, &endpoints, observer)?;
    let data_system = match items {
        Some(endpoint) => Some(data_system::elsewhere(Agent::new(endpoint, outbox(config)?), pace)),
        // Without a file the run keeps the items itself.
        None => {
            let items = config.database.as_deref().map(data_system::Store::open_alone).transpose()?;
            items.map(|items| data_system::here(items, ANSWER_TICKS, pace))
        }
    };
    let mut hwsc = Hwsc::new(job.steps.clone(), TIME_LIMIT).with_retries(config.retry);
    if config.stand_by {
        hwsc = hwsc.on_stand_by();
    }
    if let Some(((place, question), tick)) = place {
        hwsc = hwsc.resumed_at(place, tick).with_question(question);
    }
    let workstation = match commands {
        Some(endpoint) if config.stand_alone => {
            WorkstationSource::Switched(Box::new(Switched::new(hwsc, endpoint, config.wait)))
        }
        Some(endpoint) => WorkstationSource::outside(endpoint),
        None => WorkstationSource::Emulator(Box::new(JobPlayer::new(hwsc))),
    };
    let pedestal = regrips.map(|endpoint| Box::new(pedestal::Agent::new(endpoint)));
    let vision =
        sees.map(|endpoint| vision::Port::new(endpoint, config.seed, Analysis::fingerprint(description)));
    let neighbours = Neighbours::new(workstation, data_system, pedestal, vision, network);
    Ok(neighbours.unchecked(config.unchecked))
}

/// The file for updates that wait for a Data System in another process.
fn outbox(config: &RunConfig) -> Result<Outbox, StartError> {
    if config.database.is_some() {
        return Err(StartError::DataBaseElsewhere);
    }
    let file = &config.outbox;
    if let Some(directory) = file.parent().filter(|path| !path.as_os_str().is_empty()) {
        fs::create_dir_all(directory)
            .map_err(|source| StartError::Read { path: directory.to_owned(), source })?;
    }
    Ok(Outbox::open(file)?)
}

/// The faults of `--faults`, and the text of the file; empty without the option.
fn faults(config: &RunConfig, cell: &CellDescription) -> Result<(FaultFile, String), StartError> {
    let Some(path) = &config.faults else { return Ok(Default::default()) };
    let (faults, text) = fault_file(path, cell)?;
    if config.robot.kind != RobotKind::Sim && faults.line.is_some() {
        return Err(StartError::FaultsAtPort);
    }
    Ok((faults, text))
}

/// Read a fault file. Also returns its text. Errors: [`StartError`], with all errors of the file.
pub fn fault_file(path: &Path, cell: &CellDescription) -> Result<(FaultFile, String), StartError> {
    let text = files::read_text(path).map_err(|source| StartError::Read { path: path.to_owned(), source })?;
    let source = Source { name: path.display().to_string(), text: text.clone().into() };
    match text::parse(&source, cell) {
        Ok(faults) => Ok((faults, text)),
        Err(report) => {
            Err(StartError::Data { what: format!("the faults of {}", source.name), report: Box::new(report) })
        }
    }
}
