//! `rcs-run check`: loads everything that a run needs, and prints the findings.

#[cfg(test)]
#[path = "../tests/common/data.rs"]
mod data;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod variants;

use std::{
    collections::HashMap,
    io::{self, IsTerminal as _},
    path::Path,
    process::ExitCode,
    sync::{Arc, Mutex, PoisonError},
};

use crate::pages::DataArgument;
use diagnostics::{
    DataGroup, Diagnostic, Diagnostics, FAULTS, FIELDS, Finding, Group, JOBS, Problems, ROBOTS, Severity,
    Source, grouped,
};
use executive::egm::{RobotFile, placement::PlacementError};
use os_io::{
    console::{self, shown},
    files,
    replace::{Format, check_output, replace},
    text::amount,
};
use paths::known::Known;
use plant::{
    Cell, CellDescription,
    description::{CELL, source},
};
use serde::Serialize;
use taskdata::load::{Job, Store};

use runtime::{StartError, agreement, field, setup::fault_file};

use crate::rcs_run::{
    answer::answer_long_json,
    arguments::CheckArguments,
    error::{Error, UNUSABLE},
    explain, pose,
    reach::Reach,
    ways,
};

#[derive(Serialize)]
struct Outcome {
    ok: bool,
    errors: usize,
    warnings: usize,
    files: usize,
    blocks: usize,
    records: serde_json::Map<String, serde_json::Value>,
    jobs: Vec<String>,
    /// Jobs that a mapping cannot execute; `rcs-run` refuses them with that mapping.
    not_by_field: Vec<String>,
    findings: Vec<Finding>,
    data: Vec<OfDatum>, // the findings by the datum that is probably wrong, the worst datum first
    /// Reach of the arm of `--robot`.
    #[serde(skip_serializing_if = "Option::is_none")]
    reach: Option<Reach>,
}

#[derive(Serialize)]
struct OfDatum {
    datum: String,
    findings: usize,
    of: usize,
    errors: usize,
    positions: Vec<usize>, // positions of its findings in `findings`, errors first
}

/// Load and report. Exit status 0 without errors, else 2.
pub fn check(arguments: &CheckArguments) -> Result<ExitCode, Error> {
    let named = arguments.directory.clone().map(DataArgument::from);
    let data = named.unwrap_or_else(|| arguments.data.clone());
    let arguments = &CheckArguments { data, ..arguments.clone() };
    if !files::is_directory(&arguments.data) {
        return Err(StartError::NoData(arguments.data.to_path_buf()).into());
    }
    if let Some(command) = &arguments.explain {
        return explain::explain(arguments, command);
    }
    if let Some(name) = &arguments.place {
        return pose::place(&arguments.data, name, arguments.json);
    }
    if let Some(job) = &arguments.explain_job {
        return ways::explain(arguments, job);
    }
    let checked = Checked::of(&arguments.data, &Flights::default());
    if let Some((path, cell)) = arguments.urdf.as_ref().zip(checked.cell.as_ref()) {
        check_output(path, Format::Urdf, [])
            .and_then(|()| replace(path, cell.scene(&[]).urdf().as_bytes()))
            .map_err(|source| Error::Write { path: path.clone(), source })?;
    }
    let mut outcome = checked.outcome();
    let robot = arguments.robot.as_ref().filter(|_| outcome.ok);
    outcome.reach = robot.map(|robot| Reach::of(&arguments.data, robot)).transpose()?;
    if arguments.json {
        answer_long_json(&outcome)?;
    } else {
        console::drawn(&checked.text(arguments.all))?;
        console::answer(&outcome.reach.as_ref().map_or_else(String::new, ToString::to_string))?;
    }
    let is_reached = outcome.reach.as_ref().is_none_or(Reach::is_complete);
    if let Some(robot) = arguments.robot.as_ref().filter(|_| !is_reached) {
        os_io::stderr_line!(
            "rcs-run: robot {robot} does not reach all poses and paths: see the lines with ERROR"
        );
    }
    if !outcome.ok {
        os_io::stderr_line!(
            "rcs-run: {} cannot be used: {}",
            arguments.data.display(),
            amount(outcome.errors, "error")
        );
    }
    Ok(ExitCode::from(if outcome.ok && is_reached { 0 } else { UNUSABLE }))
}

/// Errors and warnings of a data directory, as text.
pub fn findings(data: &Path) -> (Vec<String>, Vec<String>) {
    let checked = Checked::of(data, &Flights::default());
    let all = checked.reports.iter().flat_map(|(_, report)| report.diagnostics());
    let words = |diagnostic: &Diagnostic| {
        let help = diagnostic.help().map_or_else(String::new, |help| format!("; {help}"));
        format!("{}: {}{help}", diagnostic.place(), diagnostic.message())
    };
    let (errors, warnings): (Vec<_>, Vec<_>) =
        all.partition(|diagnostic| diagnostic.severity() == Severity::Error);
    (errors.into_iter().map(words).collect(), warnings.into_iter().map(words).collect())
}

/// Motions that this process has already simulated, by the text of the cell description.
#[derive(Default)]
struct Flights(Mutex<HashMap<Arc<str>, Arc<Known>>>);

impl Flights {
    fn of(&self, cell: &Source) -> Arc<Known> {
        let mut cells = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(cells.entry(Arc::clone(&cell.text)).or_default())
    }
}

struct Checked {
    /// Reports with their titles: task data, jobs, cell description, faults and robots.
    reports: Vec<(String, Diagnostics)>,
    jobs: Vec<String>,
    /// Jobs that a mapping cannot execute, with the reasons.
    not_by_field: Vec<String>,
    /// The cell, if its description has no errors.
    cell: Option<Cell>,
}

impl Checked {
    /// Check everything under a data directory. Motions of the same cell are not simulated again.
    fn of(data: &Path, flights: &Flights) -> Self {
        let (store, report) = match Store::load_part(data) {
            Ok((store, report)) => (Ok(store), report),
            Err((part, report)) => (Err(part), *report),
        };
        let mut reports = vec![("task data".to_owned(), report)];
        let path = data.join(CELL);
        let (cell, of_cell) = cell(&path, store.as_ref().ok());
        let (mut names, mut sound, mut rows) = (Vec::new(), Vec::new(), Vec::new());
        for job in JOBS.all(data) {
            let name = job.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let report = match (&store, &cell) {
                (Err(part), _) => Job::check_part(&job, part),
                (Ok(store), cell) => match (Job::load(&job, store), cell) {
                    (Ok((job, report)), Some((cell, source))) => {
                        let of_job = agreement::of_job(&job, source, cell.description(), store, &path);
                        let report = report.with(of_job);
                        if !report.has_errors() {
                            sound.push(job);
                            rows.push(reports.len());
                        }
                        report
                    }
                    (Ok((_, report)), None) => report,
                    (Err(report), _) => *report,
                },
            };
            reports.push((format!("job {name}"), report));
            names.push(name);
        }
        let not_by_field = not_by_field(data, &sound);
        if let (Ok(store), Some((cell, source))) = (&store, &cell) {
            let known = flights.of(source);
            let (of_jobs, of_stored) = ways::of_all(&sound, store, cell.description(), &known);
            for (row, found) in rows.into_iter().zip(of_jobs).chain([(0, of_stored)]) {
                if let Some((_, report)) = reports.get_mut(row) {
                    *report = std::mem::take(report).with(found);
                }
            }
        }
        if let [_, jobs @ ..] = reports.as_mut_slice() {
            Diagnostics::merge_repeated(&mut jobs.iter_mut().map(|(_, report)| report).collect::<Vec<_>>());
        }
        reports.push(("cell description".to_owned(), of_cell));
        if let Some((cell, _)) = &cell {
            reports.push(("faults".to_owned(), faults(data, cell.description())));
            reports.push(("field I/O".to_owned(), mappings(data)));
        }
        reports.push(("robots".to_owned(), robots(data)));
        Self { reports, jobs: names, not_by_field, cell: cell.map(|(cell, _)| cell) }
    }

    fn findings(&self) -> Vec<&Diagnostic> {
        self.reports.iter().flat_map(|(_, report)| report.diagnostics()).collect()
    }

    /// The findings, grouped by the datum that is probably wrong, with the worst datum first.
    fn by_datum(&self) -> Vec<OfDatum> {
        let suspects: Vec<DataGroup> = self.findings().into_iter().map(Diagnostic::suspects).collect();
        let of_datum = |Group { datum, findings, errors }| OfDatum {
            datum,
            findings: findings.len(),
            of: suspects.len(),
            errors,
            positions: findings,
        };
        grouped(&suspects).into_iter().map(of_datum).collect()
    }

    /// The findings of each datum, the worst first, and a summary of each report. Without `all`, one finding per datum.
    fn text(&self, all: bool) -> String {
        let graphical = io::stdout().is_terminal();
        let findings = self.findings();
        let mut text = String::new();
        let mut left_out = 0;
        for OfDatum { datum, findings: count, of, positions, .. } in self.by_datum() {
            text += &shown(&format!("{datum}: {count} of {}\n", amount(of, "finding")));
            let printed = if all { count } else { 1 };
            left_out += count - printed;
            for one in positions.iter().take(printed).filter_map(|&at| findings.get(at)) {
                let one = one.render(graphical);
                text += &if graphical { one } else { shown(&one).into_owned() };
            }
        }
        if left_out > 0 {
            text += &format!("{left_out} more of these data: --all prints them\n");
        }
        for (what, report) in &self.reports {
            text += &shown(&format!("{what}: {}\n", report.summary().trim_end()));
        }
        for refused in &self.not_by_field {
            text += &shown(&format!("{refused}\n"));
        }
        text
    }

    fn outcome(&self) -> Outcome {
        let all = || self.reports.iter().map(|(_, report)| report);
        let (errors, warnings) = (
            all().map(|report| report.errors().count()).sum(),
            all().map(|report| report.warnings().count()).sum(),
        );
        let data = self.reports.first().map(|(_, report)| report);
        let loaded = data.into_iter().flat_map(|report| &report.loaded);
        Outcome {
            ok: errors == 0,
            errors,
            warnings,
            files: data.map_or(0, |report| report.files),
            blocks: data.map_or(0, |report| report.blocks),
            records: loaded.map(|one| (one.file.to_owned(), one.records.into())).collect(),
            jobs: self.jobs.clone(),
            not_by_field: self.not_by_field.clone(),
            findings: all().flat_map(|report| report.diagnostics()).map(Finding::from).collect(),
            data: self.by_datum(),
            reach: None,
        }
    }
}

/// The cell, the text of its description, and the findings in it, both alone and together with the task data.
fn cell(path: &Path, store: Option<&Store>) -> (Option<(Cell, Source)>, Diagnostics) {
    let mut problems = Problems::default();
    let text = match files::read_text(path) {
        Ok(text) => text,
        Err(error) => {
            problems.unreadable(&path.display().to_string(), &error);
            return (None, Diagnostics::without_text(problems));
        }
    };
    let description = match CellDescription::from_toml(&text) {
        Ok(description) => description,
        Err(report) => return (None, report),
    };
    let cell = Cell::new(&description, 1);
    if let Err(error) = &cell {
        problems.general("cell", error.to_string());
    }
    let source = source(&text);
    let report = Diagnostics::of_file(problems, &source);
    let report = match store {
        Some(store) => report.with(agreement::of_cell(source.clone(), &description, store)),
        None => report,
    };
    (cell.ok().map(|cell| (cell, source)), report)
}

fn faults(data: &Path, cell: &CellDescription) -> Diagnostics {
    let mut all = Diagnostics::default();
    for path in FAULTS.all(data) {
        all.files += 1;
        match fault_file(&path, cell) {
            Ok(_) => {}
            Err(StartError::Data { report, .. }) => all = all.with(*report),
            Err(error) => all = all.with(one(&path, &error)),
        }
    }
    all
}

fn mappings(data: &Path) -> Diagnostics {
    let mut all = Diagnostics::default();
    for path in FIELDS.all(data) {
        all.files += 1;
        match field::read(&path) {
            Ok(_) => {}
            Err(StartError::Data { report, .. }) => all = all.with(*report),
            Err(error) => all = all.with(one(&path, &error)),
        }
    }
    all
}

/// The jobs that a mapping of a data directory cannot execute. A directory may have mappings of several cells, so such
/// a job is not an error of the data.
fn not_by_field(data: &Path, jobs: &[Job]) -> Vec<String> {
    let mut refused = Vec::new();
    for path in FIELDS.all(data) {
        // A wrong mapping is reported separately.
        let Ok(mapping) = field::read(&path) else { continue };
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        refused.extend(jobs.iter().filter_map(|job| {
            let lines = field::refused_lines(&mapping, job);
            let why = lines.first()?;
            Some(format!("{} is refused with --field {name}: {why}", job.name))
        }));
    }
    refused
}

/// The findings in the robot files of a data directory.
fn robots(data: &Path) -> Diagnostics {
    let mut all = Diagnostics::default();
    for path in ROBOTS.all(data) {
        all.files += 1;
        if let Err(error) = RobotFile::load(&path) {
            all = all.with(match error {
                PlacementError::Text(report) => *report,
                error => one(&path, &error),
            });
        }
    }
    all
}

fn one(path: &Path, error: &dyn std::error::Error) -> Diagnostics {
    let mut problems = Problems::default();
    problems.general("file", format!("{}: {error}", path.display()));
    Diagnostics::without_text(problems)
}
