//! `rcs-run check`: loads everything that a run needs, and prints what was found.

use std::{
    fs, io,
    path::{Path, PathBuf},
    process::ExitCode,
};

use os_io::{console, files};
use plant::{
    Cell, CellDescription,
    description::{DescriptionError, TextSpan},
};
use serde::Serialize;
use taskdata::load::{
    Diagnostic, Diagnostics, Job, Severity, Source, Store, places::Places, report::Problems, source::At,
};

use crate::{
    agreement,
    cli::CheckArguments,
    error::{Error, UNUSABLE},
    explain, long_json,
    run::setup::{CELL, EXTENSION, JOBS},
    ways,
};

/// One finding, for editors and scripts.
#[derive(Serialize)]
struct Finding {
    severity: &'static str,
    code: String,
    /// The file, relative to the data directory; as given for files that could not be read.
    file: String,
    /// `OFFSET` and `BLOCK#`, if it stands in a block.
    offset: Option<u32>,
    block: Option<u32>,
    /// Line of the block from 0, as the manual counts, or of the file from 1 where there is no block.
    line: Option<u32>,
    /// Column from 1, and the number of characters from there on.
    column: Option<u32>,
    length: Option<u32>,
    place: String,
    message: String,
    /// What was expected there.
    expected: Option<String>,
    /// The nearest known name.
    nearest: Option<String>,
    help: Option<String>,
}

/// The outcome, for scripts.
#[derive(Serialize)]
struct Outcome {
    ok: bool,
    errors: usize,
    warnings: usize,
    files: usize,
    blocks: usize,
    records: serde_json::Map<String, serde_json::Value>,
    jobs: Vec<String>,
    findings: Vec<Finding>,
}

/// Load and report. Exit status 0 if a run could begin, else 2.
pub fn check(arguments: &CheckArguments) -> Result<ExitCode, Error> {
    let named = arguments.directory.clone().unwrap_or_else(|| arguments.data.clone());
    let arguments = &CheckArguments { data: named, ..arguments.clone() };
    if !arguments.data.is_dir() {
        return Err(Error::NoData(arguments.data.clone()));
    }
    if let Some(command) = &arguments.explain {
        return explain::explain(arguments, command);
    }
    if let Some(job) = &arguments.explain_job {
        return ways::explain(arguments, job);
    }
    let (store, data) = match Store::load(&arguments.data) {
        Ok((store, report)) => (Some(store), report),
        Err(report) => (None, *report),
    };
    let mut outcome = Outcome {
        ok: true,
        errors: 0,
        warnings: 0,
        files: data.files,
        blocks: data.blocks,
        records: data.loaded.iter().map(|l| (l.file.to_owned(), l.records.into())).collect(),
        jobs: Vec::new(),
        findings: Vec::new(),
    };
    let mut reports = vec![("task data".to_owned(), data)];
    let path = arguments.data.join(CELL);
    let (cell, cell_report) = cell(&path, store.as_ref());
    let (mut sound, mut rows) = (Vec::new(), Vec::new());
    for job in jobs(&arguments.data) {
        // Without task data a job cannot be checked: the names of its commands mean nothing yet.
        let Some(store) = &store else { break };
        let name = job.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let report = match Job::load(&job, store) {
            Ok((job, report)) => match &cell {
                Some(cell) => {
                    let report = report.with(agreement::of_job(&job, cell.description(), store, &path));
                    if !report.has_errors() {
                        sound.push(job);
                        rows.push(reports.len());
                    }
                    report
                }
                None => report,
            },
            Err(report) => *report,
        };
        reports.push((format!("job {name}"), report));
        outcome.jobs.push(name);
    }
    if let Some((store, cell)) = store.as_ref().zip(cell.as_ref()) {
        let (of_jobs, of_stored) = ways::of_all(&sound, store, cell.description());
        for (row, found) in rows.into_iter().zip(of_jobs).chain([(0, of_stored)]) {
            if let Some((_, report)) = reports.get_mut(row) {
                *report = std::mem::take(report).with(found);
            }
        }
    }
    reports.push(("cell description".to_owned(), cell_report));
    if let Some((path, cell)) = arguments.urdf.as_ref().zip(cell) {
        fs::write(path, cell.urdf()).map_err(|source| Error::Write { path: path.clone(), source })?;
    }
    for (_, report) in &reports {
        outcome.findings.extend(report.diagnostics().iter().map(finding));
    }
    let count = |severity| outcome.findings.iter().filter(|finding| finding.severity == severity).count();
    (outcome.errors, outcome.warnings) = (count("error"), count("warning"));
    outcome.ok = outcome.errors == 0;
    console::answer(&if arguments.json { long_json(&outcome)? } else { text(&reports) })?;
    if !outcome.ok {
        os_io::stderr_line!(
            "rcs-run: {} cannot be used: {}",
            arguments.data.display(),
            amount(outcome.errors, "error")
        );
    }
    Ok(ExitCode::from(if outcome.ok { 0 } else { UNUSABLE }))
}

/// The cell of a description, and what is wrong with that, by itself and beside the task data.
fn cell(path: &Path, store: Option<&Store>) -> (Option<Cell>, Diagnostics) {
    let mut problems = Problems::default();
    let text = match files::read_text(path) {
        Ok(text) => text,
        Err(error) => {
            problems.unreadable(&path.display().to_string(), &error);
            return (None, Diagnostics::new(problems, Places::in_lines(&[]), 0, Vec::new()));
        }
    };
    let description = match CellDescription::from_toml(&text) {
        Ok(description) => description,
        Err(error) => return (None, cell_report(text, &error)),
    };
    let cell = Cell::new(&description, 1);
    if let Err(error) = &cell {
        problems.general("cell", error.to_string());
    }
    let source = source(text);
    let report = Diagnostics::new(problems, Places::in_lines(std::slice::from_ref(&source)), 0, Vec::new());
    let report = match store {
        Some(store) => report.with(agreement::of_cell(source, &description, store)),
        None => report,
    };
    (cell.ok(), report)
}

pub fn source(text: String) -> Source {
    Source { name: CELL.to_owned(), text: text.into() }
}

/// The faults of a cell description, told as those of task data are.
pub fn cell_report(text: String, error: &DescriptionError) -> Diagnostics {
    let mut problems = Problems::default();
    match error {
        DescriptionError::Faults(faults) => {
            for fault in faults.all() {
                let (message, place) = (fault.message.clone(), fault.place);
                match place {
                    Some(place) => problems.error(fault.code, at(&place), message),
                    None => problems.general(fault.code, message),
                }
                if let Some(expected) = &fault.expected {
                    problems.expected(expected);
                }
                if let Some(nearest) = &fault.nearest {
                    problems.nearest("one", nearest);
                }
            }
        }
        DescriptionError::Unreadable { .. } => problems.general("file", error.to_string()),
    }
    Diagnostics::new(problems, Places::in_lines(&[source(text)]), 0, Vec::new())
}

/// A piece of a file without blocks.
pub fn at(place: &TextSpan) -> At {
    let small = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
    At { source: 0, start: small(place.start), length: small(place.length) }
}

/// All jobs of a data directory.
pub fn jobs(data: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(data.join(JOBS)).into_iter().flatten().flatten();
    let mut jobs: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|e| e == EXTENSION))
        .collect();
    jobs.sort();
    jobs
}

fn finding(diagnostic: &Diagnostic) -> Finding {
    Finding {
        severity: match diagnostic.severity() {
            Severity::Error => "error",
            Severity::Warning => "warning",
        },
        code: diagnostic.code().to_owned(),
        file: diagnostic.file().to_owned(),
        offset: diagnostic.block().map(|block| block.offset),
        block: diagnostic.block().map(|block| block.number),
        line: diagnostic.line(),
        column: diagnostic.column(),
        length: diagnostic.length(),
        place: diagnostic.place(),
        message: diagnostic.message().to_owned(),
        expected: diagnostic.expected().map(str::to_owned),
        nearest: diagnostic.nearest().map(str::to_owned),
        help: diagnostic.help().map(str::to_owned),
    }
}

fn text(reports: &[(String, Diagnostics)]) -> String {
    use std::io::IsTerminal as _;
    let graphical = io::stdout().is_terminal();
    let line =
        |(what, report): &(String, Diagnostics)| format!("{what}: {}\n", report.render(graphical).trim_end());
    reports.iter().map(line).collect()
}

fn amount(count: usize, one: &str) -> String {
    if count == 1 { format!("1 {one}") } else { format!("{count} {one}s") }
}
