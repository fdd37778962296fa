//! `rcs-log why`: explains a failure, or what each level did in a tick, and by which row.
//!
//! The explanation begins with the first failure in the world ([`world`]): a contact, a lost part, a warning of the
//! robot controller, or a line of the workstation that could not be executed. A failure is a chain of causes
//! ([`closed_loop::chain`]): the commands that led to the failed process, with their rows; the inputs of the devices
//! meanwhile ([`evidence`]); events in the cell; the first cause; and the reports up to Task. All statements come from
//! the log, without guesses.
//!
//! An injected fault is a circumstance of a simulated run, listed in addition, and never a cause.

mod data;
mod evidence;
mod rung;
mod world;

use std::{
    fmt,
    path::{Path, PathBuf},
    process::ExitCode,
};

use closed_loop::{
    account::Account,
    chain::{self, Chain, History, Link, Processes, Report, Root},
    failure::Failure,
};
use levels::ladder::ProcessId;
use rcs_core::tick::{TICK_S, Tick};
use record::{Log, explanation as attached, proto::foxglove::Level, tables};
use runtime::result::FailureResult;
use serde::Serialize;

use self::{rung::Rung, world::World};
use crate::{
    Answer, Error, print,
    story::{CommandHistory, Moment, open, walk},
};

const LINES_BEFORE: usize = 12; // number of log lines shown before a tick
const LINES_MEANWHILE: usize = 8; // number of lines about cell and link shown with a failure

/// Source of lines about events in the cell. Such a line has the tick after the event.
const CELL: &str = "cell";
const FAULT: &str = "fault"; // source of lines about injected faults

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

#[derive(Debug, Serialize)]
pub struct Explanation {
    tick: u64,
    seconds: f64,
    /// Remark for a log without the decision tables of this program.
    #[serde(skip_serializing_if = "Option::is_none")]
    tables: Option<&'static str>,
    world: Option<World>, // the first failure in the world; `None` if a tick was requested
    failure: Option<Story>, // the failure that began in this tick; `None` if a tick was requested
    remedy: Option<String>, // the action of a person before the job can continue, if it is known
    faults: Vec<LineBefore>, // injected faults up to the tick, oldest first
    ended: Option<String>, // the ending of the run, if it was not the failure of a process
    /// Log lines before the tick, oldest first; for a failure, the events of cell and link during the command.
    before: Vec<LineBefore>,
    levels: Vec<Rung>,
}

#[derive(Debug, Serialize)]
pub struct Story {
    #[serde(flatten)]
    report: Report,
    first_cause: String,
    evidence: Vec<String>,
    /// Tick of the first command that led to the failure. Later events in the cell can be related to it.
    #[serde(skip)]
    begun: u64,
}

#[derive(Debug, Serialize)]
struct LineBefore {
    tick: u64,
    source: String,
    text: String,
}

pub fn why(arguments: &Arguments) -> Result<ExitCode, Error> {
    let log = open(&arguments.file)?;
    let explanation = explanation(&log, &arguments.file, arguments.tick)?;
    if let Some(remark) = explanation.tables {
        os_io::stderr_line!("rcs-log: {}: {remark}", arguments.file.display());
    }
    print(&explanation, arguments.answer.json)?;
    Ok(ExitCode::SUCCESS)
}

/// Explains a tick, or the failure if none is requested. Fails if the log does not have the tick.
pub fn explanation(log: &Log, path: &Path, requested: Option<u64>) -> Result<Explanation, Error> {
    let (processes, origin) = tables::of_log(log);
    let (command_history, history) = read(log, path, processes)?;
    let failed = command_history.failed(log).filter(|_| requested.is_none());
    let reported = match &failed {
        Some(failed) => failed.account.of_process().cloned(),
        None => command_history.failure.filter(|_| requested.is_none()),
    };
    let chain = failed.as_ref().map(|failed| chain_of(failed, &history));
    let account = failed.as_ref().map(|failed| &failed.account);
    let attached = chain.as_ref().and_then(|chain| chain.report.clone());
    let story = reported.as_ref().and_then(|failure| tell(log, &history, failure, account, attached));
    let remedy = failed.as_ref().and_then(|failed| failed.remedy.clone()).or_else(|| {
        let process = ProcessId::from_text(&reported.as_ref()?.process)?;
        let report = history.report(process, reported.as_ref()?.tick.0)?;
        attached::remedy(log, report.reason)
    });
    let of_kind = || account.and_then(|account| account.first.kind.remedy()).map(str::to_owned);
    let remedy = remedy.or_else(of_kind);
    let first = account.map(|account| account.first.tick.0);
    let world = failed.zip(chain).map(|(failed, chain)| world::first(log, failed.account, &chain));
    let tick = requested.or(story.as_ref().map(|story| story.report.tick)).or(first);
    let moment = find(log, path, tick)?;
    let mut explanation = explain(log, &moment, world, story, processes);
    (explanation.tables, explanation.remedy) = (origin.remark(), remedy);
    Ok(explanation)
}

/// The chain of causes of a failure, as attached by the run or else from the ticks of the log.
fn chain_of(failed: &FailureResult, history: &History) -> Chain {
    failed.chain.clone().unwrap_or_else(|| Chain::of(&failed.account, history))
}

/// Reads the commands of a log and the history of every process.
fn read(log: &Log, path: &Path, processes: Processes) -> Result<(CommandHistory, History), Error> {
    let (mut command_history, mut history) = (CommandHistory::new(processes), History::new(processes));
    walk(log, path, |moment| {
        command_history.note(moment);
        history.note(moment.tick, &moment.external, &moment.after);
        true
    })?;
    Ok((command_history, history))
}

/// The command that led to the first failure, if any, with its tick. Fails if the log cannot be read.
pub fn last_command(log: &Log, path: &Path) -> Result<Option<Link>, Error> {
    let (command_history, history) = read(log, path, tables::of_log(log).0)?;
    if let Some(failed) = command_history.failed(log) {
        return Ok(chain_of(&failed, &history).last_command().cloned());
    }
    let report = command_history.failure.and_then(|failure| Report::of(&failure, &history));
    Ok(report.and_then(|(_, mut report)| report.commands.pop()))
}

/// Explains a failure from its commands to its first cause. `account` has the earlier failures, `attached` its report.
fn tell(
    log: &Log,
    history: &History,
    failure: &Failure,
    account: Option<&Account>,
    attached: Option<Report>,
) -> Option<Story> {
    let (root, found) = Report::of(failure, history)?;
    let report = attached.unwrap_or(found);
    let since = history.command(root.process, root.tick).map_or(1, |command| command.tick);
    let begun = report.commands.iter().find(|link| link.process != "HWSC").map_or(since, |link| link.tick);
    let found = evidence::gather(log, root.process, since, root.tick);
    let first_cause = match account.map(|account| &account.first) {
        Some(first) if first != failure => {
            format!("{} at tick {}: {}", first.kind.text(), first.tick, first.text)
        }
        _ => first_cause(history, root, since, &found),
    };
    let evidence = found.guard.into_iter().chain(found.devices).collect();
    Some(Story { report, first_cause, evidence, begun })
}

fn first_cause(history: &History, root: Root, since: u64, found: &evidence::Evidence) -> String {
    let name = history.info(root.process).name;
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

fn explain(
    log: &Log,
    moment: &Moment,
    world: Option<World>,
    failure: Option<Story>,
    processes: Processes,
) -> Explanation {
    let begun = failure.as_ref().map(|story| story.begun);
    let last = moment.tick.0 + u64::from(world.is_some() || begun.is_some());
    let lines: Vec<_> = log.lines().filter(|line| line.tick.0 <= last).collect();
    let shown = |line: &record::reader::LogLine| {
        let (source, text) = (line.source.clone(), line.text.clone());
        LineBefore { tick: line.tick.0, source, text }
    };
    let is_fault = |line: &&record::reader::LogLine| line.source == FAULT;
    let mut faults: Vec<LineBefore> = lines.iter().filter(is_fault).map(shown).collect();
    faults.drain(..faults.len().saturating_sub(LINES_MEANWHILE));
    let other = lines.iter().filter(|line| !is_fault(line)).filter(|line| match begun {
        // The chain already contains commands and failures.
        Some(begun) => line.tick.0 >= begun && (line.source == CELL || line.level == Level::Warning),
        None => line.level != Level::Debug,
    });
    let mut before: Vec<LineBefore> = other.map(shown).collect();
    let ended = log.end.as_ref().and_then(|end| end.get("result")).filter(|_| failure.is_none()).cloned();
    let most = if failure.is_some() { LINES_MEANWHILE } else { LINES_BEFORE };
    before.drain(..before.len().saturating_sub(most));
    Explanation {
        tick: moment.tick.0,
        seconds: moment.tick.0 as f64 * TICK_S,
        tables: None,
        world,
        failure,
        remedy: None,
        faults,
        ended,
        before,
        levels: rung::all(moment, processes),
    }
}

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(world) = &self.world {
            for sentence in world.account.sentences() {
                writeln!(f, "{sentence}.")?;
            }
            self.remedy(f)?;
            let told =
                self.failure.as_ref().is_some_and(|story| story.report.text == world.account.first.text);
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
                lines(&self.before, f)?;
            }
        }
        if !self.faults.is_empty() {
            writeln!(f, "\nInjected faults, which this run was to simulate:")?;
            lines(&self.faults, f)?;
        }
        writeln!(f, "\nIn tick {} ({:.2} s), from Task down:", self.tick, self.seconds)?;
        self.levels.iter().try_for_each(|level| write!(f, "{level}"))
    }
}

impl Explanation {
    fn tell(&self, story: &Story, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Story { report, first_cause, evidence, .. } = story;
        if self.world.is_none() {
            writeln!(f, "Failure at tick {} ({:.2} s). {}.", self.tick, self.seconds, report.text)?;
            self.remedy(f)?;
        }
        writeln!(f, "First cause: {first_cause}.")?;
        links("The commands that led there:", &report.commands, f)?;
        links("From the failure to its cause, each because of the next:", &report.causes, f)?;
        list("What was sensed while it tried:", evidence, f)?;
        if !self.before.is_empty() {
            writeln!(f, "\nMeanwhile, in the cell and on the link:")?;
            lines(&self.before, f)?;
        }
        links("What followed:", &report.consequences, f)
    }

    fn remedy(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.remedy.iter().try_for_each(|remedy| writeln!(f, "To do: {remedy}."))
    }
}

fn lines(lines: &[LineBefore], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    lines.iter().try_for_each(|LineBefore { tick, source, text }| {
        writeln!(f, "  tick {tick:>6}  {source:<12} {text}")
    })
}

fn links(title: &str, links: &[Link], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let line = |Link { tick, process, text }: &Link| format!("tick {tick:>6}  {process} {text}");
    list(title, &links.iter().map(line).collect::<Vec<_>>(), f)
}

fn list(title: &str, lines: &[String], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    if lines.is_empty() {
        return Ok(());
    }
    writeln!(f, "\n{title}")?;
    lines.iter().try_for_each(|line| writeln!(f, "  {line}"))
}
