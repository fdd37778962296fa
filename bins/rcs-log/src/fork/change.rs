//! Changes of a run: their text form, and their checks before the run begins.

use std::{
    fmt, io,
    path::{Path, PathBuf},
    str::FromStr,
};

use diagnostics::alternatives;
use os_io::files;
use plant::{
    CellDescription,
    fault::text::{self, FaultFile},
};
use runtime::{ChangeError, Run, setup::CELL};
use taskdata::load::{Diagnostics, Job, Source, Step, Store, Workstation, job::JobLine};

use super::datum::{Datum, DatumError, Words};

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Change {
    /// Replace a word of the task data.
    Datum(Datum),
    /// Insert a line before the next line of the job.
    Line(String),
    /// Execute a command instead of the next one.
    Command(String),
    /// Use another seed of the noise.
    Seed(u64),
    /// Enable the faults of a file.
    Fault(PathBuf),
    /// Replace a value of the cell description.
    Cell {
        key: String, // key in the file, such as `vise.friction`
        value: String,
    },
}

impl FromStr for Change {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(datum) = text.strip_prefix("datum ") {
            return datum.trim().parse().map(Self::Datum);
        }
        let Some((what, value)) = text.split_once('=') else { return Err(unknown(text)) };
        let (what, value) = (what.trim(), value.trim());
        if let Some(key) = what.strip_prefix("cell ") {
            return Ok(Self::Cell { key: key.trim().to_owned(), value: value.to_owned() });
        }
        match what {
            "line" => Ok(Self::Line(value.to_owned())),
            "command" if value.starts_with("==") => Ok(Self::Command(value.to_owned())),
            "command" => Ok(Self::Command(format!("== {value}"))),
            "seed" => {
                value.parse().map(Self::Seed).map_err(|_| format!("seed=N was expected; found {value}"))
            }
            "fault" => Ok(Self::Fault(value.into())),
            _ => Err(unknown(text)),
        }
    }
}

fn unknown(text: &str) -> String {
    format!(
        "`datum PLACE=VALUE`, line=LINE, command=COMMAND, seed=N, fault=FILE or `cell KEY=VALUE` was expected; found {text}"
    )
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Datum(datum) => datum.fmt(f),
            Self::Line(line) => write!(f, "before the next line of the job: {line}"),
            Self::Command(command) => write!(f, "the next command: {command}"),
            Self::Seed(seed) => write!(f, "seed {seed}"),
            Self::Fault(path) => write!(f, "faults of {}", path.display()),
            Self::Cell { key, value } => write!(f, "{CELL}, {key}: {value}"),
        }
    }
}

#[derive(Debug, thiserror::Error)]
pub enum RefusedChange {
    #[error(transparent)]
    Datum(#[from] DatumError),
    #[error("with this change the task data have errors:\n{0}")]
    Data(String),
    #[error("this is not a line of a job:\n{0}")]
    Line(String),
    #[error("one {0} other than `** load` was expected: `datum` changes task data")]
    NotOne(&'static str),
    #[error("{}: {source}", path.display())]
    Read { path: PathBuf, source: io::Error },
    #[error("{}", .0.in_line())]
    Faults(Diagnostics),
    #[error("cell.toml has no value {key}: {known}")]
    Key { key: String, known: String },
    #[error("{0} is not a TOML value")]
    Value(String),
    #[error("{0}")]
    Description(String),
}

#[derive(Debug, thiserror::Error)]
#[error("the change is refused ({what}): {why}")]
pub struct Refusal {
    what: String,
    why: RefusedChange,
}

/// An operation on a run, made from a change.
pub enum Operation {
    Data(Source),
    Line(JobLine),
    /// Execute a command instead of the next one.
    Command(JobLine),
    Seed(u64),
    Faults(Box<FaultFile>),
}

impl Operation {
    /// Applies the operation to a run; `seed` is the seed of the faults.
    pub fn apply(self, run: &mut Run, seed: u64) -> Result<(), ChangeError> {
        match self {
            Self::Data(source) => run.change_data(source),
            Self::Line(line) => run.insert_line(line),
            Self::Command(line) => run.replace_command(line),
            Self::Seed(seed) => {
                run.change_seed(seed);
                Ok(())
            }
            Self::Faults(faults) => run.add_faults(&faults, seed),
        }
    }
}

impl Change {
    fn refused(&self, why: impl Into<RefusedChange>) -> Box<Refusal> {
        Box::new(Refusal { what: self.to_string(), why: why.into() })
    }

    /// Applies a change of the cell description to its text; other changes leave the text unchanged.
    pub fn described(&self, text: &str) -> Result<String, Box<Refusal>> {
        let Self::Cell { key, value } = self else { return Ok(text.to_owned()) };
        with_value(text, key, value).map_err(|why| self.refused(why))
    }
}

pub fn description(text: &str) -> Result<CellDescription, Box<Refusal>> {
    CellDescription::from_toml(text).map_err(|error| {
        let why = RefusedChange::Description(error.to_string());
        Box::new(Refusal { what: CELL.to_owned(), why })
    })
}

/// Converts changes to operations, with the task data and the cell of the tick, except changes of the cell description.
pub fn operations(
    changes: &[Change],
    store: &Store,
    cell: &CellDescription,
) -> Result<Vec<Operation>, Box<Refusal>> {
    let mut words = Words::default();
    let mut operations = Vec::new();
    for change in changes {
        let operation = match change {
            Change::Cell { .. } => continue,
            Change::Datum(datum) => {
                words.change(store, datum).map_err(|why| change.refused(why))?;
                continue;
            }
            Change::Seed(seed) => Ok(Operation::Seed(*seed)),
            Change::Line(text) => line(text, store).map(Operation::Line),
            Change::Command(text) => line(text, store).and_then(command).map(Operation::Command),
            Change::Fault(path) => faults(path, cell),
        };
        operations.push(operation.map_err(|why| change.refused(why))?);
    }
    // Changed words of one entry may be valid only together, so they are checked together.
    if let Some(source) = words.source() {
        if let Err(report) = store.with_blocks(vec![source.clone()]) {
            let why = RefusedChange::Data(report.render(false));
            return Err(Box::new(Refusal { what: "task data".to_owned(), why }));
        }
        operations.push(Operation::Data(source));
    }
    Ok(operations)
}

fn faults(path: &Path, cell: &CellDescription) -> Result<Operation, RefusedChange> {
    let text =
        files::read_text(path).map_err(|source| RefusedChange::Read { path: path.to_owned(), source })?;
    let source = Source { name: path.display().to_string(), text: text.into() };
    let faults = text::parse(&source, cell).map_err(RefusedChange::Faults)?;
    Ok(Operation::Faults(Box::new(faults)))
}

fn line(text: &str, store: &Store) -> Result<JobLine, RefusedChange> {
    let source = Source { name: "--set".to_owned(), text: text.into() };
    let (job, _) =
        Job::from_source(source, store).map_err(|report| RefusedChange::Line(report.render(false)))?;
    let loads = |line: &JobLine| {
        matches!(
            line.step,
            Step::Workstation(Workstation::Load { .. })
                | Step::After { action: Workstation::Load { .. }, .. }
        )
    };
    match <[JobLine; 1]>::try_from(job.steps) {
        Ok([line]) if !loads(&line) => Ok(line),
        _ => Err(RefusedChange::NotOne("line")),
    }
}

fn command(line: JobLine) -> Result<JobLine, RefusedChange> {
    if matches!(line.step, Step::Command(_)) { Ok(line) } else { Err(RefusedChange::NotOne("command")) }
}

/// Replaces a value in the text of a cell description.
pub fn with_value(text: &str, key: &str, value: &str) -> Result<String, RefusedChange> {
    let wrong = |error: toml::de::Error| RefusedChange::Description(error.to_string());
    let mut table: toml::Table = text.parse().map_err(wrong)?;
    let new: toml::Table =
        format!("value = {value}").parse().map_err(|_| RefusedChange::Value(value.to_owned()))?;
    let new = new.get("value").filter(|_| new.len() == 1).cloned();
    let new = new.ok_or_else(|| RefusedChange::Value(value.to_owned()))?;
    let mut parts = key.split('.');
    let first = parts.next().unwrap_or_default();
    let mut place = table.get_mut(first).ok_or(());
    for part in parts {
        place = place.and_then(|at| match at {
            toml::Value::Table(table) => table.get_mut(part).ok_or(()),
            toml::Value::Array(all) => part.parse().ok().and_then(|at: usize| all.get_mut(at)).ok_or(()),
            _ => Err(()),
        });
    }
    let Ok(place) = place else { return Err(missing(&table, key)) };
    *place = new;
    let text = toml::to_string(&table).map_err(|error| RefusedChange::Description(error.to_string()))?;
    CellDescription::from_toml(&text).map_err(|error| RefusedChange::Description(error.to_string()))?;
    Ok(text)
}

/// The error for an unknown key, with the known keys at this place.
fn missing(table: &toml::Table, key: &str) -> RefusedChange {
    let mut known: Vec<String> = table.keys().cloned().collect();
    let mut at: Option<&toml::Value> = None;
    for part in key.split('.') {
        let next = match at {
            None => table.get(part),
            Some(at) => at.get(part),
        };
        let Some(toml::Value::Table(inner)) = next else { break };
        known = inner.keys().cloned().collect();
        at = next;
    }
    let last = key.rsplit('.').next().unwrap_or(key);
    let known = alternatives(last, known.iter().map(String::as_str), "there are");
    RefusedChange::Key { key: key.to_owned(), known }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell() -> String {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../data/cell.toml");
        std::fs::read_to_string(path).unwrap()
    }

    #[test]
    fn documented_changes_parse() {
        let read = |text: &str| text.parse::<Change>();
        assert_eq!(read("seed=7"), Ok(Change::Seed(7)));
        assert_eq!(read("line=** wait 50"), Ok(Change::Line("** wait 50".to_owned())));
        assert_eq!(read("command=PAUSE"), Ok(Change::Command("== PAUSE".to_owned())));
        assert_eq!(read("command=== PAUSE"), Ok(Change::Command("== PAUSE".to_owned())));
        let (key, value) = ("vise.friction".to_owned(), "0.15".to_owned());
        assert_eq!(read("cell vise.friction=0.15"), Ok(Change::Cell { key, value }));
        assert!(matches!(read("datum a.blk:1:2:3=4"), Ok(Change::Datum(_))));
        for wrong in ["", "seed=x", "seed", "row=GRASP-OBJ 3", "datum a.blk=1"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn value_of_the_cell_is_replaced() {
        let changed = with_value(&cell(), "gripper.parts.friction", "0.15").unwrap();
        let description = CellDescription::from_toml(&changed).unwrap();
        assert!((description.gripper.parts.friction - 0.15).abs() < 1e-12);
        let centre = CellDescription::from_toml(&with_value(&cell(), "tray.0.floor", "-17.5").unwrap());
        assert!((centre.unwrap().tray[0].floor + 17.5).abs() < 1e-12);
    }

    #[test]
    fn unknown_value_is_refused_with_the_known_ones() {
        let text = |key, value| with_value(&cell(), key, value).unwrap_err().to_string();
        let error = text("vise.fricton", "0.1");
        assert_eq!(error, "cell.toml has no value vise.fricton: the nearest is friction");
        assert_eq!(text("vise.friction", "a b"), "a b is not a TOML value");
        assert!(text("vise.friction", "-3.0").contains("friction"));
    }
}
