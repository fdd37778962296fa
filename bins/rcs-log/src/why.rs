//! `rcs-log why`: what each level did in a tick, and by which row: in the tick in which a failure began, or in any
//! other. Before it stand the lines of the log that led there.

use std::{fmt, path::PathBuf, process::ExitCode};

use executive::failure::{self, action, cells};
use levels::ladder::Ladder;
use rcs_core::tick::{TICK_S, Tick};
use record::{Log, proto::foxglove::Level};
use serde::Serialize;

use crate::{
    Answer, Error, print,
    story::{Chronicle, Moment, open, walk},
};

/// Lines of the log that are shown before the tick.
const LINES_BEFORE: usize = 12;

/// Arguments of `why`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// The log
    pub file: PathBuf,
    /// The tick to explain [default: the one in which the last failure began]
    #[arg(long, value_name = "N")]
    pub tick: Option<u64>,
    #[command(flatten)]
    answer: Answer,
}

/// An explanation.
#[derive(Debug, Serialize)]
struct Explanation {
    tick: u64,
    seconds: f64,
    /// The failure that began here, if one was asked for.
    failure: Option<String>,
    /// What led here: lines of the log, oldest first.
    before: Vec<LineBefore>,
    /// Each process, from Task down.
    levels: Vec<Rung>,
}

#[derive(Debug, Serialize)]
struct LineBefore {
    tick: u64,
    source: String,
    text: String,
}

/// What a process did.
#[derive(Debug, Serialize)]
struct Rung {
    process: String,
    command: String,
    /// The process was not stepped: dormant, or held.
    held: bool,
    table: Option<String>,
    row: Option<u8>,
    /// State variables of the row, and what they were: only those that the row asks for.
    conditions: Vec<String>,
    action: Option<String>,
    next: Option<String>,
}

/// Explain a tick and print it.
pub fn why(arguments: &Arguments) -> Result<ExitCode, Error> {
    let log = open(&arguments.file)?;
    let (tick, failure) = match arguments.tick {
        Some(tick) => (Some(tick), None),
        None => {
            let mut chronicle = Chronicle::default();
            walk(&log, &arguments.file, |moment| {
                chronicle.note(moment);
                true
            })?;
            match chronicle.failure {
                Some(failure) => (Some(failure.tick.0), Some(failure.text)),
                None => (None, None),
            }
        }
    };
    let moment = find(&log, arguments, tick)?;
    print(&explain(&log, &moment, failure), arguments.answer.json)?;
    Ok(ExitCode::SUCCESS)
}

/// The tick that was asked for, or the last one.
fn find(log: &Log, arguments: &Arguments, tick: Option<u64>) -> Result<Moment, Error> {
    let (mut first, mut last, mut found) = (None, Tick::BEFORE_START, None);
    walk(log, &arguments.file, |moment| {
        first.get_or_insert(moment.tick.0);
        last = moment.tick;
        if tick.is_none_or(|tick| tick == moment.tick.0) {
            found = Some(Moment { ..*moment });
        }
        tick.is_none() || found.is_none()
    })?;
    let path = || arguments.file.clone();
    let first = first.ok_or_else(|| Error::Empty(path()))?;
    found.ok_or_else(|| Error::NoTick { path: path(), tick: tick.unwrap_or_default(), first, last: last.0 })
}

fn explain(log: &Log, moment: &Moment, failure: Option<String>) -> Explanation {
    let headers = failure::headers(&moment.after);
    let levels = Ladder::processes().iter().zip(headers).enumerate().map(|(index, (process, header))| {
        let command = failure::command(index, &moment.external.hws, &moment.before);
        let table = process.table(header.table);
        let row = table.and_then(|table| table.row(header.row).map(|row| (table, row)));
        let conditions = row.map_or_else(Vec::new, |(table, row)| {
            let named = table.columns.iter().zip(cells(row)).filter(|(_, cell)| !cell.is_empty());
            named.map(|(column, cell)| format!("{column} is {cell}")).collect()
        });
        Rung {
            process: process.name.to_owned(),
            command,
            held: header.republished,
            table: row.map(|(table, _)| table.name.to_owned()),
            row: row.map(|(_, row)| row.number),
            conditions,
            action: row.map(|(_, row)| action(row)),
            next: row.map(|(_, row)| row.next.to_owned()),
        }
    });
    let mut before: Vec<LineBefore> = log
        .lines()
        .filter(|line| line.tick <= moment.tick && line.level != Level::Debug)
        .map(|line| LineBefore { tick: line.tick.0, source: line.source, text: line.text })
        .collect();
    before.drain(..before.len().saturating_sub(LINES_BEFORE));
    Explanation {
        tick: moment.tick.0,
        seconds: moment.tick.0 as f64 * TICK_S,
        failure,
        before,
        levels: levels.collect(),
    }
}

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.failure {
            Some(failure) => writeln!(f, "{failure}\n")?,
            None => writeln!(f, "No failure is explained here.\n")?,
        }
        writeln!(f, "Before it:")?;
        for line in &self.before {
            writeln!(f, "  tick {:>6}  {:<12} {}", line.tick, line.source, line.text)?;
        }
        writeln!(f, "\nIn tick {} ({:.2} s), from Task down:", self.tick, self.seconds)?;
        self.levels.iter().try_for_each(|level| write!(f, "{level}"))
    }
}

impl fmt::Display for Rung {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let command = if self.command.is_empty() { "nothing" } else { &self.command };
        let held = if self.held { " (not stepped: dormant or held)" } else { "" };
        writeln!(f, "  {:<14} executes {command}{held}", self.process)?;
        let (Some(table), Some(row), Some(action), Some(next)) =
            (&self.table, self.row, &self.action, &self.next)
        else {
            return Ok(());
        };
        let because = if self.conditions.is_empty() {
            "whatever the state".to_owned()
        } else {
            format!("because {}", self.conditions.join(", "))
        };
        writeln!(f, "  {:<14} {table} row {row}: {action}, then {next}, {because}", "")
    }
}
