//! `rcs-log info`: what ran, how long it took, its commands, and how it ended.

use std::{
    collections::BTreeMap,
    fmt,
    path::{Path, PathBuf},
    process::ExitCode,
};

use closed_loop::account::Account;
use interfaces::t3i::LinkCounters;
use os_io::text::amount;
use rcs_core::tick::{TICK_S, Tick};
use record::{
    Log,
    proto::foxglove::Level,
    tables,
    views::{Changes, JobState},
};
use runtime::result::FailureResult;
use serde::Serialize;

use crate::{
    Answer, Error, print,
    story::{CommandHistory, CommandStory, open, walk},
};

/// Arguments of `info`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// The log
    pub file: PathBuf,
    #[command(flatten)]
    answer: Answer,
}

#[derive(Debug, Serialize)]
pub struct Info {
    file: String,
    bytes: usize,
    run: BTreeMap<String, String>, // facts that the run recorded at its start
    ticks: u64,
    seconds: f64,
    missing_ticks: u64, // number of ticks that the recorder dropped
    /// Times of the controller; `None` if the log has none, as in a run with fast clock.
    times: Option<Times>,
    complete: bool,         // the log has its end record; the log of a killed run has none
    damage: Option<String>, // the reason why part of the file cannot be read
    result: Option<String>,
    digest: Option<String>,
    commands: Vec<CommandStory>,
    /// The last line of the job that was begun, as `line 5 of 13: ...`; `None` in the log of an older program.
    job: Option<String>,
    link: Link,
    failure: Option<FailureResult>, // the first failure, its consequences, and what led there
    facts: BTreeMap<String, String>, // facts that the run recorded at its end: parts, faults, verdicts
    warnings: usize,                // number of warnings and of errors on `/log`
    errors: usize,
    attachments: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Times {
    overruns: u64, // number of skipped slots of the 40 ms grid
    p50_us: f64,   // time of the controller part of a tick, us: median, 99th percentile, maximum
    p99_us: f64,
    max_us: f64,
}

impl Times {
    /// A summary of the times of all ticks, ns; `None` if there are no times.
    fn new(mut nanoseconds: Vec<u64>, overruns: u64) -> Option<Self> {
        nanoseconds.sort_unstable();
        let last = nanoseconds.len().checked_sub(1)?;
        let at = |percent: usize| nanoseconds.get(last * percent / 100).map_or(0.0, |ns| *ns as f64 / 1e3);
        Some(Self { overruns, p50_us: at(50), p99_us: at(99), max_us: at(100) })
    }
}

#[derive(Debug, Default, Serialize)]
struct Link {
    frames: u32,
    acknowledged: u32,
    naks: u32,
    timeouts: u32,
    restarts: u32,
    checksum_errors: u32,
    limited: u32,
}

impl From<&LinkCounters> for Link {
    fn from(counters: &LinkCounters) -> Self {
        Self {
            frames: counters.frames,
            acknowledged: counters.acknowledged,
            naks: counters.naks,
            timeouts: counters.timeouts,
            restarts: counters.restarts,
            checksum_errors: counters.checksum_errors,
            limited: counters.limited,
        }
    }
}

pub fn info(arguments: &Arguments) -> Result<ExitCode, Error> {
    let log = open(&arguments.file)?;
    print(&summary(&log, &arguments.file)?, arguments.answer.json)?;
    Ok(ExitCode::SUCCESS)
}

/// The summary of a log. Fails with [`Error::Read`] if the log cannot be read, [`Error::Empty`] without a tick.
pub fn summary(log: &Log, path: &Path) -> Result<Info, Error> {
    let (mut command_history, mut link) = (CommandHistory::new(tables::of_log(log).0), Link::default());
    let (mut ticks, mut missing, mut last) = (0, 0, Tick::BEFORE_START);
    let (mut times, mut overruns) = (Vec::new(), 0);
    walk(log, path, |moment| {
        command_history.note(moment);
        link = Link::from(&moment.after.t3i.status.counters);
        missing += moment.gap;
        if let Some(timing) = moment.timing {
            times.push(timing.controller_ns);
            overruns = timing.skipped;
        }
        ticks += 1;
        last = moment.tick;
        true
    })?;
    if ticks == 0 {
        return Err(Error::Empty(path.to_owned()));
    }
    let level = |level| log.lines().filter(|line| line.level == level).count();
    let end = |key: &str| log.end.as_ref().and_then(|end| end.get(key)).cloned();
    let failure = command_history.failed(log);
    Ok(Info {
        file: path.display().to_string(),
        bytes: log.size(),
        run: log.run.clone(),
        ticks,
        seconds: last.0 as f64 * TICK_S,
        missing_ticks: missing,
        times: Times::new(times, overruns),
        complete: log.complete,
        damage: log.damage(),
        result: end("result"),
        digest: end("digest"),
        commands: command_history.commands,
        link,
        facts: facts(log),
        job: job(log),
        failure,
        warnings: level(Level::Warning),
        errors: level(Level::Error),
        attachments: log.attachments.iter().map(|attachment| attachment.name.clone()).collect(),
    })
}

fn job(log: &Log) -> Option<String> {
    let changes = Changes::<JobState>::of(log);
    let JobState { index, lines, text, outcome, .. } = changes.last().filter(|job| job.lines > 0)?;
    Some(format!("line {index} of {lines}: {text}, {outcome}"))
}

/// Entries of the end record that the recorder itself writes.
const RECORDER: [&str; 8] =
    ["digest", "result", "ticks", "gaps", "lost_ticks", "lost_frames", "lost_notes", "lost_files"];

/// The facts at the end of the run, without the recorder's own.
fn facts(log: &Log) -> BTreeMap<String, String> {
    let end = log.end.iter().flatten();
    end.filter(|(key, value)| !RECORDER.contains(&key.as_str()) && !value.is_empty())
        .map(|(key, value)| (key.clone(), value.clone()))
        .collect()
}

impl fmt::Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of = |key: &str| self.run.get(key).map_or("unknown", String::as_str);
        writeln!(
            f,
            "run        {} {}, commit {}, job {}, seed {}, clock {}, robot {}",
            of("program"),
            of("version"),
            of("commit"),
            of("job"),
            of("seed"),
            of("clock"),
            of("robot")
        )?;
        writeln!(f, "started    {}", of("command_line"))?;
        writeln!(f, "data       {}", of("data"))?;
        let end = match (&self.result, self.complete) {
            (Some(result), true) => result.clone(),
            _ => "the log has no end: the run was killed, or its log could not be written".to_owned(),
        };
        writeln!(f, "ended      {end}")?;
        self.job.iter().try_for_each(|job| writeln!(f, "job        {job}"))?;
        writeln!(
            f,
            "length     {}, {:.1} s; {} missing; {:.1} MB, {}, {}",
            amount(self.ticks, "tick"),
            self.seconds,
            amount(self.missing_ticks, "tick"),
            self.bytes as f64 / 1e6,
            amount(self.warnings, "warning"),
            amount(self.errors, "error")
        )?;
        if let Some(damage) = &self.damage {
            writeln!(f, "damage     {damage}")?;
        }
        if let Some(Times { overruns, p50_us, p99_us, max_us }) = &self.times {
            writeln!(
                f,
                "controller p50 {p50_us:.1} us, p99 {p99_us:.1} us, max {max_us:.1} us; {} skipped",
                amount(*overruns, "slot")
            )?;
        }
        let Link { frames, acknowledged, naks, timeouts, restarts, checksum_errors, limited } = &self.link;
        writeln!(
            f,
            "link       {}, {acknowledged} acknowledged, {}, {timeouts} without answer, {}, {}, {} limited",
            amount(*frames, "frame"),
            amount(*naks, "NAK"),
            amount(*restarts, "re-start"),
            amount(*checksum_errors, "checksum error"),
            amount(*limited, "point")
        )?;
        if let Some(digest) = &self.digest {
            writeln!(f, "digest     {digest}")?;
        }
        for (key, value) in Account::without_account(&self.facts) {
            writeln!(f, "{:<10} {}", key.replace('_', " "), value.replace("; ", "\n           "))?;
        }
        writeln!(f, "\n  tick       s  for s  status     command")?;
        for command in &self.commands {
            let begin = command.first_tick as f64 * TICK_S;
            let length = (command.last_tick - command.first_tick + 1) as f64 * TICK_S;
            let (tick, status) = (command.first_tick, &command.status);
            let remark = command.remark();
            writeln!(f, "{tick:>6} {begin:>7.1} {length:>6.1}  {status:<10} {}{remark}", command.text)?;
        }
        let Some(FailureResult { account, remedy, .. }) = &self.failure else { return Ok(()) };
        writeln!(f)?;
        account.sentences().try_for_each(|sentence| writeln!(f, "{sentence}"))?;
        remedy.iter().try_for_each(|remedy| writeln!(f, "To do: {remedy}"))
    }
}
