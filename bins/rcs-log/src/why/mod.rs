//! `rcs-log why`: explains a failure, or what each level did in a tick, and by which row.
//!
//! The explanation begins with the first failure in the world ([`world`]): a contact, a lost part, a warning of
//! the robot controller, or a line of the workstation that could not be executed. A failure is explained as a
//! chain of causes over the ticks ([`chain`]): the commands that led to the failed process, each with its row;
//! the inputs of the devices during the command ([`evidence`]); events in the cell; the first cause; and the
//! reports up to Task. All statements come from buffers and rows of the log ([`history`]), without guesses.

mod chain;
mod data;
mod evidence;
mod history;
mod world;

use std::{
    fmt,
    path::{Path, PathBuf},
    process::ExitCode,
};

use closed_loop::{
    account::Account,
    failure::{self, Failure},
};
use levels::ladder::{Ladder, ProcessId};
use rcs_core::tick::{TICK_S, Tick};
use record::{
    Log,
    proto::foxglove::Level,
    rows::{beside, values_text},
};
use serde::Serialize;

pub use self::{chain::Link, history::History};
use self::{
    chain::Root,
    history::{because, conditions, effect, info},
    world::World,
};
use crate::{
    Answer, Error, print,
    story::{Chronicle, Moment, open, walk},
};

/// Number of log lines shown before a tick.
const LINES_BEFORE: usize = 12;
/// Number of lines about cell and link shown with a failure.
const LINES_MEANWHILE: usize = 8;

/// Sources of lines about events around the robot: the cell and injected faults. Such a line has the tick after
/// the event.
const EVENTS: [&str; 2] = ["cell", FAULT];
const FAULT: &str = "fault";

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

/// An explanation of a tick or a failure.
#[derive(Debug, Serialize)]
pub struct Explanation {
    tick: u64,
    seconds: f64,
    /// The first failure in the world; `None` if a tick was requested.
    world: Option<World>,
    /// The failure that began in this tick; `None` if a tick was requested.
    failure: Option<Story>,
    /// The ending of the run, if it was not the failure of a process.
    ended: Option<String>,
    /// Log lines before the tick, oldest first; for a failure, the events of cell and link during the command.
    before: Vec<LineBefore>,
    levels: Vec<Rung>,
}

#[derive(Debug, Serialize)]
pub struct Story {
    /// Tick in which the failure began.
    pub tick: u64,
    pub text: String,
    /// The commands that led to the failed process, from the workstation controller down.
    pub commands: Vec<Link>,
    /// The causes, from the failure to the first cause.
    pub causes: Vec<Link>,
    /// Process and tick of the first cause, in a sentence.
    pub first_cause: String,
    /// Inputs of the devices during the command.
    pub evidence: Vec<String>,
    /// The reports of the failure up to Task.
    pub consequences: Vec<Link>,
}

/// A failure, and the tick from which events in the cell can be related to it.
pub struct Told {
    pub story: Story,
    /// Tick of the first command that led to the failure.
    pub begun: u64,
}

#[derive(Debug, Serialize)]
struct LineBefore {
    tick: u64,
    source: String,
    text: String,
}

/// Action of a process in a tick.
#[derive(Debug, Serialize)]
struct Rung {
    process: String,
    command: String,
    /// The process was not executed, because it was dormant or held.
    held: bool,
    /// Tick in which the row fired, if the process has not decided since.
    old: Option<u64>,
    /// Values of the state variables of the table when the row fired.
    values: Option<String>,
    /// Rows of other tables that fired in the same execution of the process, with their values.
    beside: Vec<String>,
    table: Option<String>,
    row: Option<u8>,
    /// Conditions of the row: its step and state variables, with the values for which it fired.
    conditions: Vec<String>,
    /// Action of the row, with its parameters.
    action: Option<String>,
    /// Next step, if the row changes it.
    next: Option<String>,
    /// Step of the command after the row; empty for none.
    step: String,
    /// Action and next step as text.
    #[serde(skip)]
    effect: String,
}

pub fn why(arguments: &Arguments) -> Result<ExitCode, Error> {
    let log = open(&arguments.file)?;
    print(&explanation(&log, &arguments.file, arguments.tick)?, arguments.answer.json)?;
    Ok(ExitCode::SUCCESS)
}

/// The explanation of a tick, or of the failure if no tick is requested.
///
/// # Errors
/// [`Error::Read`] if the log cannot be read, [`Error::NoTick`] if it does not have the tick.
pub fn explanation(log: &Log, path: &Path, requested: Option<u64>) -> Result<Explanation, Error> {
    let (chronicle, history) = read(log, path)?;
    let account = chronicle.account(log).filter(|_| requested.is_none());
    let reported = match &account {
        Some(account) => account.of_process().cloned(),
        None => chronicle.failure.filter(|_| requested.is_none()),
    };
    let told = reported.and_then(|failure| tell(log, &history, &failure, account.as_ref()));
    let failed_at = told.as_ref().map(|told| told.story.tick);
    let world = account.map(|account| world::first(log, &history, account));
    let first = world.as_ref().map(|world| world.account.first.tick.0);
    let tick = requested.or(failed_at).or(first);
    let moment = find(log, path, tick)?;
    Ok(explain(log, &moment, world, told))
}

/// Reads the commands of a log and the history of every process.
fn read(log: &Log, path: &Path) -> Result<(Chronicle, History), Error> {
    let (mut chronicle, mut history) = (Chronicle::default(), History::default());
    walk(log, path, |moment| {
        chronicle.note(moment);
        history.note(moment);
        true
    })?;
    Ok((chronicle, history))
}

/// The last command that led to the first failure in a log, with its tick, if there is a failure.
///
/// # Errors
/// [`Error::Read`] if the log cannot be read.
pub fn last_command(log: &Log, path: &Path) -> Result<Option<Link>, Error> {
    let (chronicle, history) = read(log, path)?;
    let account = chronicle.account(log);
    let reported = account.as_ref().map_or(chronicle.failure, |account| account.of_process().cloned());
    let mut commands = account.map_or_else(Vec::new, |account| world::first(log, &history, account).commands);
    if commands.is_empty() {
        let told = reported.and_then(|failure| tell(log, &history, &failure, None));
        commands = told.map_or_else(Vec::new, |told| told.story.commands);
    }
    Ok(commands.pop())
}

/// Explains a failure that a process began to report in a tick, from its commands to its first cause. `account`
/// has the earlier failures.
pub fn tell(log: &Log, history: &History, failure: &Failure, account: Option<&Account>) -> Option<Told> {
    let at = ProcessId::from_text(&failure.process)?;
    let (tick, text) = (failure.tick.0, failure.text.clone());
    let (root, causes) = chain::down(history, at, tick);
    let commands = chain::commands(history, root);
    let since = history.command(root.process, root.tick).map_or(1, |command| command.tick);
    let begun = commands.iter().find(|link| link.process != "HWSC").map_or(since, |link| link.tick);
    let found = evidence::gather(log, root.process, since, root.tick);
    let mut first_cause = match account.map(|account| &account.first) {
        Some(first) if first != failure => {
            format!("{} at tick {}: {}", first.kind.text(), first.tick, first.text)
        }
        _ => first_cause(history, root, since, &found),
    };
    let injected = log.lines().filter(|line| line.source == FAULT && line.tick.0 <= root.tick + 1).last();
    if let Some(line) = injected {
        first_cause += &format!("; the faults of the run, at tick {}: {}", line.tick, line.text);
    }
    let evidence = found.guard.into_iter().chain(found.devices).collect();
    let consequences = chain::up(history, at, tick);
    let story = Story { tick, text, commands, causes, first_cause, evidence, consequences };
    Some(Told { story, begun })
}

/// The end of the trace, in a sentence.
fn first_cause(history: &History, root: Root, since: u64, found: &evidence::Evidence) -> String {
    let name = info(root.process).name;
    let seconds = root.tick.saturating_sub(since) as f64 * TICK_S;
    let trying = format!("{seconds:.2} s after its command");
    match (&found.guard, history.report(root.process, root.tick)) {
        (Some(guard), _) => format!("{name} at tick {}, {trying}, because {guard}", root.tick),
        (None, Some(report)) if chain::has_failed(root.process, report.reason) => {
            format!("{name} at tick {}, {trying}: {}", root.tick, report.reason)
        }
        (None, Some(report)) => {
            format!("{name} at tick {}, {trying}, which reported {}", root.tick, report.report)
        }
        (None, None) => format!("{name} at tick {}, {trying}", root.tick),
    }
}

/// The requested tick, or the last one.
fn find(log: &Log, path: &Path, tick: Option<u64>) -> Result<Moment, Error> {
    let (mut first, mut last, mut found) = (None, Tick::BEFORE_START, None);
    walk(log, path, |moment| {
        first.get_or_insert(moment.tick.0);
        last = moment.tick;
        if tick.is_none_or(|tick| tick == moment.tick.0) {
            found = Some(Moment { ..*moment });
        }
        tick.is_none() || found.is_none()
    })?;
    let path = || path.to_owned();
    let first = first.ok_or_else(|| Error::Empty(path()))?;
    found.ok_or_else(|| Error::NoTick { path: path(), tick: tick.unwrap_or_default(), first, last: last.0 })
}

fn explain(log: &Log, moment: &Moment, world: Option<World>, told: Option<Told>) -> Explanation {
    let levels = Ladder::processes().iter().zip(ProcessId::ALL).map(|(process, id)| {
        let header = moment.after.header(*id);
        let command = failure::command(*id, &moment.external.hws, &moment.before);
        let fired = process.fired(header);
        let row = fired.map(|fired| fired.row);
        let step = header.step.unwrap_or_default();
        Rung {
            process: process.name.to_owned(),
            command,
            held: header.republished,
            old: header.basis.filter(|_| header.age() > Some(0)).map(|basis| basis.tick.0),
            values: fired.and_then(|fired| Some(values_text(fired.table, fired.values?))),
            beside: beside(process, header).collect(),
            table: fired.map(|fired| fired.table.name.to_owned()),
            row: row.map(|row| row.number),
            conditions: fired.as_ref().map_or_else(Vec::new, conditions),
            action: row.map(|row| row.call().to_string()),
            next: row.and_then(|row| row.next).map(str::to_owned),
            step: step.to_string(),
            effect: row.map_or_else(String::new, |row| effect(row, step.as_str())),
        }
    });
    let (failure, begun) = told.map_or((None, None), |told| (Some(told.story), Some(told.begun)));
    let mut before: Vec<LineBefore> = log
        .lines()
        .filter(|line| line.tick.0 <= moment.tick.0 + u64::from(begun.is_some()))
        .filter(|line| match begun {
            // The chain already contains commands and failures.
            Some(begun) => {
                line.tick.0 >= begun
                    && (EVENTS.contains(&line.source.as_str()) || line.level == Level::Warning)
            }
            None => line.level != Level::Debug,
        })
        .map(|line| LineBefore { tick: line.tick.0, source: line.source, text: line.text })
        .collect();
    let ended = log.end.as_ref().and_then(|end| end.get("result")).filter(|_| failure.is_none()).cloned();
    let most = if failure.is_some() { LINES_MEANWHILE } else { LINES_BEFORE };
    before.drain(..before.len().saturating_sub(most));
    Explanation {
        tick: moment.tick.0,
        seconds: moment.tick.0 as f64 * TICK_S,
        world,
        failure,
        ended,
        before,
        levels: levels.collect(),
    }
}

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(world) = &self.world {
            for sentence in world.account.sentences() {
                writeln!(f, "{sentence}.")?;
            }
            let told = self.failure.as_ref().is_some_and(|story| story.text == world.account.first.text);
            if !told {
                links("The commands that led there:", &world.commands, f)?;
            }
            list("The data that the last of them used:", &world.data, f)?;
            writeln!(f)?;
        }
        match &self.failure {
            Some(story) => self.tell(story, f)?,
            None => {
                if let Some(ended) = self.ended.as_ref().filter(|_| self.world.is_none()) {
                    writeln!(f, "The run ended: {ended}")?;
                }
                writeln!(f, "No control process has reported a failure.\n\nBefore it:")?;
                self.lines(f)?;
            }
        }
        writeln!(f, "\nIn tick {} ({:.2} s), from Task down:", self.tick, self.seconds)?;
        self.levels.iter().try_for_each(|level| write!(f, "{level}"))
    }
}

impl Explanation {
    fn tell(&self, story: &Story, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.world.is_none() {
            writeln!(f, "Failure at tick {} ({:.2} s). {}.", self.tick, self.seconds, story.text)?;
        }
        writeln!(f, "First cause: {}.", story.first_cause)?;
        links("The commands that led there:", &story.commands, f)?;
        links("From the failure to its cause, each because of the next:", &story.causes, f)?;
        list("What was sensed while it tried:", &story.evidence, f)?;
        if !self.before.is_empty() {
            writeln!(f, "\nMeanwhile, in the cell and on the link:")?;
            self.lines(f)?;
        }
        links("What followed:", &story.consequences, f)
    }

    fn lines(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.before.iter().try_for_each(|LineBefore { tick, source, text }| {
            writeln!(f, "  tick {tick:>6}  {source:<12} {text}")
        })
    }
}

/// Links under a title; empty without links.
fn links(title: &str, links: &[Link], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let line = |Link { tick, process, text }: &Link| format!("tick {tick:>6}  {process} {text}");
    list(title, &links.iter().map(line).collect::<Vec<_>>(), f)
}

/// Lines under a title; empty without lines.
fn list(title: &str, lines: &[String], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    if lines.is_empty() {
        return Ok(());
    }
    writeln!(f, "\n{title}")?;
    lines.iter().try_for_each(|line| writeln!(f, "  {line}"))
}

impl fmt::Display for Rung {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let command = if self.command.is_empty() { "nothing" } else { &self.command };
        let held = if self.held { " (not stepped: dormant or held)" } else { "" };
        writeln!(f, "  {:<14} executes {command}{held}", self.process)?;
        let (Some(table), Some(row)) = (&self.table, self.row) else { return Ok(()) };
        let old = self.old.map_or_else(String::new, |tick| format!("no row since tick {tick}, when it was "));
        writeln!(f, "  {:<14} {old}{table} row {row}: {}, {}", "", self.effect, because(&self.conditions))?;
        if let Some(values) = self.values.as_ref().filter(|values| !values.is_empty()) {
            writeln!(f, "  {:<14} values: {values}", "")?;
        }
        self.beside.iter().try_for_each(|row| writeln!(f, "  {:<14} also {row}", ""))
    }
}
