//! The start of a run with what the controller knew in an earlier one (docs/design/resume.md).

use std::{
    fmt, fs,
    path::{Path, PathBuf},
    time::{SystemTime, UNIX_EPOCH},
};

use closed_loop::{
    ClosedLoop, devices,
    field::{Field, FoundOutputs},
};
use field::Mapping;
use interfaces::{CommonMemory, DeviceOutputs, emove::GoneTo};
use neighbours::{
    data_system::{ANSWER_TICKS, DataSystem},
    workstation::player::{Hwsc, PlaceInJob},
};
use os_io::files;
use plant::{Cell, CellDescription, RestoreError};
use rcs_core::{digest::Digest, tick::Tick};
use record::{
    Attachment, Log,
    journal::{self, Contents, Entry, HEARTBEAT, Identity, LoggedError, RunEnd, Witnesses},
    replay,
};
use taskdata::load::{
    Job, Source, Store,
    job::{JobLine, Step, Workstation as Action},
};

use crate::{
    boards::Controller,
    config::{RobotKind, RunConfig},
    error::StartError,
    observer::Observer,
};

const LARGEST_CELL: u64 = 64 << 20; // greatest length of a saved cell, bytes

const OUTAGE: u64 = 50; // ticks for which a simulated cell is without power: 2 s
/// Ticks by which the saved cell may be older than the last entry: ten seconds, for a disk that is busy.
const OLDEST_CELL: u64 = 10 * HEARTBEAT;

pub struct Resumed {
    path: PathBuf, // the journal or the log
    contents: Contents,
    cell: Vec<u8>,
    cell_path: PathBuf,
    is_simulated: bool, // the robot is simulated, too
}

/// The causes of a change of the simulated cell, except for the motion of the robot: valves, motors, and the line of
/// the job.
pub type Causes = (DeviceOutputs, u32, bool);

#[must_use]
pub fn causes(entry: &Entry) -> Causes {
    (entry.memory.device_outputs(), entry.line, entry.begun)
}

/// The time of day, ms since 1970.
pub fn now() -> u64 {
    since_1970(SystemTime::now())
}

pub fn entry(closed: &ClosedLoop<Controller>, job: Option<&Hwsc>, written: u64) -> Entry {
    let PlaceInJob { line, is_begun, delayed, is_asked } = job.map(Hwsc::place_in_job).unwrap_or_default();
    Entry {
        tick: closed.tick(),
        written,
        over: false,
        line,
        begun: is_begun,
        delayed,
        asks_line: is_asked,
        generation: closed.generations().number(),
        hws: *closed.command(),
        memory: journal::kept(closed.memory()),
    }
}

/// Data, job and cell of a run, by their digests, and its program.
pub fn identity(config: &RunConfig, store: &Store, job: &Job, cell: &str) -> Identity {
    let job = (job.name.as_str(), job.source().text.as_ref());
    identity_of(env!("CARGO_PKG_VERSION"), store.sources(), job, cell, &config.robot.to_string())
}

fn identity_of(
    program: &str,
    sources: &[Source],
    (job, lines): (&str, &str),
    cell: &str,
    robot: &str,
) -> Identity {
    let mut data = Digest::new();
    for source in sources {
        data.add(source.name.as_bytes());
        data.add(source.text.as_bytes());
    }
    let of = |text: &str| {
        let mut digest = Digest::new();
        digest.add(text.as_bytes());
        digest.to_string()
    };
    let entries = [
        (journal::PROGRAM, program.to_owned()),
        ("data", data.to_string()),
        ("job", format!("{job} {}", of(lines))),
        ("cell", of(cell)),
        ("robot", robot.to_owned()),
    ];
    entries.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}

/// The identity of the run of a log, as that of a journal.
fn identity_of_log(log: &Log) -> Identity {
    let fact = |key: &str| log.run.get(key).map_or("", String::as_str);
    let text = |name: &str| {
        let found = log.attachment(name).map(|attachment| attachment.data.as_slice());
        String::from_utf8_lossy(found.unwrap_or_default()).into_owned()
    };
    let (lines, cell) = (text(Attachment::JOB), text(Attachment::CELL));
    let sources = replay::log_sources(&log.attachments);
    identity_of(fact("version"), &sources, (fact("job"), &lines), &cell, fact("robot"))
}

/// The contents of a journal, with the end of its run as the files beside it show it.
fn of_journal(path: &Path, cell: &Entry) -> Result<Contents, StartError> {
    let contents = journal::open(path)?;
    let log = contents.identity.get(journal::LOG).and_then(|log| Log::open(Path::new(log)).ok());
    let changed = fs::metadata(path).and_then(|metadata| metadata.modified()).ok().map(since_1970);
    Ok(journal::judged(contents, &Witnesses { cell: Some(cell), log: log.as_ref(), changed }))
}

/// The contents of a log: the image of tick `at`, or the last one.
fn of_log(path: &Path, at: Option<Tick>) -> Result<Contents, StartError> {
    let failed = |source: LoggedError| StartError::ResumedLog { path: path.to_owned(), source };
    let log = Log::open(path).map_err(|error| failed(error.into()))?;
    journal::logged(&log, identity_of_log(&log), at).map_err(failed)
}

fn since_1970(time: SystemTime) -> u64 {
    let since = time.duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_millis()).unwrap_or(u64::MAX)
}

impl Resumed {
    /// Read the journal or log of a configuration, if it names one. Fails if it cannot be used, or if the run cannot
    /// be resumed.
    pub fn load(config: &RunConfig) -> Result<Option<Self>, StartError> {
        let Some(path) = &config.resume else { return Ok(None) };
        let is_log = journal::is_log(path);
        let beside = journal::cell_beside(config.journal.as_ref().filter(|_| is_log).unwrap_or(path));
        if !is_log {
            // The reason why a journal cannot be used is more important than that of its cell.
            journal::open(path)?;
        }
        let failed = |why: String| StartError::ResumedCell { path: beside.clone(), why };
        let bytes = files::read(&beside, LARGEST_CELL).map_err(|error| failed(error.to_string()))?;
        let (entry, saved) = journal::read_cell(&bytes)
            .ok_or_else(|| failed("it is damaged, or of a program with other buffers".to_owned()))?;
        let is_simulated = config.robot.kind == RobotKind::Sim;
        let mut contents = if is_log {
            of_log(path, is_simulated.then_some(entry.tick))?
        } else {
            of_journal(path, &entry)?
        };
        if contents.newest.over {
            return Err(StartError::NothingToResume(path.clone()));
        }
        let newest = contents.newest.tick;
        if newest.since(entry.tick) > OLDEST_CELL {
            return Err(failed(format!("it is of tick {}, the last entry of tick {newest}", entry.tick)));
        }
        if is_simulated && !is_log {
            // The simulated cell ends with the run, so the power fails in the tick of its last save.
            contents = Contents { newest: entry, end: RunEnd::Reached, ..contents };
        }
        let cell = saved.to_vec();
        Ok(Some(Self { path: path.clone(), contents, cell, cell_path: beside, is_simulated }))
    }

    pub const fn entry(&self) -> &Entry {
        &self.contents.newest
    }

    /// The first entry of the journal that this run writes.
    pub fn first(&self) -> Entry {
        Entry { memory: journal::kept(&self.buffers().1), asks_line: self.place().is_asked, ..*self.entry() }
    }

    fn place(&self) -> PlaceInJob {
        let Entry { line, begun, delayed, asks_line, .. } = *self.entry();
        let is_asked = asks_line || journal::asks_for_line(self.contents.end);
        PlaceInJob { line, is_begun: begun, delayed, is_asked }
    }

    /// The place in the job, for a run whose devices execute lines by a mapping: the present one then begins again. If
    /// it may start a machine a second time, also a question to a person.
    pub fn place_with(&self, job: &Job, mapping: Option<&Mapping>) -> (PlaceInJob, Option<String>) {
        let place = self.place();
        let present = line_at(job, place).and_then(|line| Some((line, action(line)?)));
        let entry = mapping.zip(present).and_then(|(mapping, (line, action))| {
            devices::sequence(mapping, action).map(|sequence| (line, sequence))
        });
        let Some((line, sequence)) = entry.filter(|_| place.is_begun) else { return (place, None) };
        let question = (!sequence.begun.is_empty()).then(|| {
            format!("whether line {} of the job, `{}`, has begun is not known", line.line, line.text)
        });
        (PlaceInJob { is_begun: false, ..place }, question)
    }

    /// The buffers with which the controller starts, and the tick after which it does.
    pub fn buffers(&self) -> (Tick, CommonMemory) {
        let tick = self.entry().tick;
        (tick, self.contents.memory(tick))
    }

    /// The saved cell. Errors: [`StartError::ResumedCell`] if it is of another description or version.
    pub fn cell(&self, description: &CellDescription) -> Result<Cell, StartError> {
        let path = self.cell_path.clone();
        let failed = |error: RestoreError| StartError::ResumedCell { path, why: error.to_string() };
        let mut cell = Cell::restore(description, &self.cell).map_err(failed)?;
        if self.is_simulated {
            // Without power every output is zero: the arm comes to rest, and a part may fall.
            for _ in 0..OUTAGE {
                cell.step(&DeviceOutputs::default());
            }
        }
        Ok(cell)
    }

    /// Compare the run of the journal with this one. Errors: [`StartError::OtherJournal`] with all differences.
    pub fn check(&self, identity: &Identity) -> Result<(), StartError> {
        let differences = differences(&self.contents.identity, identity);
        if differences.is_empty() {
            return Ok(());
        }
        Err(StartError::OtherJournal { path: self.path.clone(), differences })
    }

    /// Start the controller with its knowledge. Errors: [`StartError::FieldNotReady`] if an output of a device is on,
    /// and the earlier run has not set it, or it may not be on at rest.
    pub fn start(
        &self,
        closed: &mut ClosedLoop<Controller>,
        job: &Job,
        observer: &mut dyn Observer,
    ) -> Result<(), StartError> {
        let entry = self.entry();
        let (tick, memory) = self.buffers();
        closed.resume(tick, &memory, &entry.hws, entry.generation);
        closed.note_resumed();
        if let Some(books) = closed.books_mut().filter(|_| memory.task.updates.connected) {
            *books = DataSystem::reconnected(ANSWER_TICKS);
            observer.message(
                "the Data System kept its items in memory, so they are lost; --database FILE keeps them",
            );
        }
        self.adopt_outputs(closed, &memory, job, observer)
    }

    fn adopt_outputs(
        &self,
        closed: &mut ClosedLoop<Controller>,
        memory: &CommonMemory,
        job: &Job,
        observer: &mut dyn Observer,
    ) -> Result<(), StartError> {
        let Some(desk) = closed.workstation.field.as_deref_mut().map(Field::desk_mut) else { return Ok(()) };
        let place = self.place();
        let present = line_at(job, place).filter(|_| place.is_begun).and_then(action);
        let station = devices::outputs_of(desk.mapping(), executed(job, place), present);
        let FoundOutputs { adopted, cleared, unknown } = desk.adopt(memory, &station);
        let refused = desk.mapping().devices.iter().enumerate().filter_map(|(index, device)| {
            let of_device = unknown.iter().filter(|(of, _)| *of == index);
            let names: Vec<&str> = of_device.map(|(_, name)| name.as_str()).collect();
            (!names.is_empty()).then(|| {
                format!(
                    "{} at {}: {} on, and the interrupted run did not set this: look at the device, then `rcs-run \
                     io-release`",
                    device.name,
                    device.address,
                    names.join(", ")
                )
            })
        });
        let refused: Vec<String> = refused.collect();
        if !refused.is_empty() {
            return Err(StartError::FieldNotReady(refused));
        }
        if !adopted.is_empty() {
            observer.message(&format!("outputs that are on and stay on: {}", adopted.join(", ")));
        }
        if !cleared.is_empty() {
            observer.message(&format!(
                "outputs that the interrupted run had set and that are off, by the fallback of the coupler or a loss \
                 of power: {}",
                cleared.join(", ")
            ));
        }
        Ok(())
    }
}

fn line_at(job: &Job, place: PlaceInJob) -> Option<&JobLine> {
    job.steps.get(usize::try_from(place.line).ok()?.checked_sub(1)?)
}

const fn action(line: &JobLine) -> Option<&Action> {
    match &line.step {
        Step::Workstation(action) => Some(action),
        Step::Command(_) | Step::After { .. } => None,
    }
}

/// The actions of the workstation before the present line that have begun, in order.
fn executed(job: &Job, place: PlaceInJob) -> Vec<&Action> {
    let count = usize::try_from(place.line).unwrap_or(usize::MAX).saturating_sub(1);
    let before = job.steps.get(..count.min(job.steps.len())).unwrap_or_default();
    let mut nearer = 0; // lines `** after` between this one and the present one
    let mut actions: Vec<&Action> = before
        .iter()
        .rev()
        .filter_map(|line| match &line.step {
            Step::Command(_) => None,
            Step::Workstation(action) => Some(action),
            Step::After { action, .. } => {
                let is_delayed = nearer < u16::BITS && place.delayed & 1 << nearer != 0;
                nearer += 1;
                (!is_delayed).then_some(action)
            }
        })
        .collect();
    actions.reverse();
    actions
}

fn differences(of_journal: &Identity, of_run: &Identity) -> Vec<String> {
    let none = String::new();
    let value = |of: &Identity, key: &String| of.get(key).unwrap_or(&none).clone();
    let differ = of_run.keys().filter(|key| value(of_journal, key) != value(of_run, key));
    differ.map(|key| format!("{key} {} there, {} here", value(of_journal, key), value(of_run, key))).collect()
}

/// The knowledge of the controller, as text.
impl fmt::Display for Resumed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let entry = self.entry();
        let memory = self.contents.memory(entry.tick);
        let estimates = &memory.emove.estimates;
        match &estimates.held {
            Some(held) => write!(f, "holds {} with grip {:+}", held.object.object, held.object.grip)?,
            None if estimates.empty => f.write_str("holds nothing")?,
            None => f.write_str("what the gripper holds is not known")?,
        }
        match (&estimates.place, &estimates.way) {
            (Some(place), _) => write!(f, "; the robot is {} {}", at(&place.gone_to), place.site.location)?,
            (None, Some(way)) => {
                write!(
                    f,
                    "; the robot is on its way from {} to {}",
                    way.from.site.location, way.to.site.location
                )?;
            }
            (None, None) => f.write_str("; the place of the robot is not known")?,
        }
        let begun = if entry.begun { "" } else { ", not begun" };
        let asked = if self.place().is_asked { "the line of the job is not known, recorded is " } else { "" };
        write!(f, "; {asked}line {} of the job{begun}; knowledge of ", entry.line)?;
        let age = now().saturating_sub(entry.written) / 1000;
        match entry.written {
            0 => write!(f, "tick {}", entry.tick)?,
            _ => write!(f, "tick {}, {age} s ago", entry.tick)?,
        }
        self.contents.end.doubt().map_or(Ok(()), |why| write!(f, "; {why}"))
    }
}

const fn at(gone_to: &GoneTo) -> &'static str {
    match gone_to {
        GoneTo::Location => "at",
        GoneTo::Object(_) | GoneTo::View(_) => "at an object in",
        GoneTo::Drum => "in the drum at",
        GoneTo::Brought(_) => "with an object at",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_of_two_runs_are_named() {
        let identity = |cell: &str| {
            Identity::from([("cell".to_owned(), cell.to_owned()), ("job".to_owned(), "linkbar".to_owned())])
        };
        assert!(differences(&identity("1"), &identity("1")).is_empty());
        assert_eq!(differences(&identity("1"), &identity("2")), ["cell 1 there, 2 here"]);
        assert_eq!(differences(&Identity::new(), &identity("2")).len(), 2);
    }
}
