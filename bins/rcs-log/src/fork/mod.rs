//! `rcs-log fork`: repeats the run of a log with a change.
//!
//! The run is repeated from tick 0 with the job, data and seed of the log ([`runtime::repeat`]), and compared bit for
//! bit. After a given tick it is changed ([`change`]). Repeating a run of four minutes takes about a second.

mod change;
mod datum;
mod error;
mod repetition;

use std::{fmt, fs, path::PathBuf, process::ExitCode, time::Instant};

use interfaces::ExternalInputs;
use os_io::replace::{Format, check_output};
use rcs_core::{plain::from_bytes, tick::TICK_S};
use record::{Attachment, Log, ReadError, ReplayError, replay::generations};
use runtime::{LogTarget, RepeatError, Run, RunConfig, repeat, setup::CELL};
use serde::Serialize;

pub use self::error::ForkError;
use self::{
    change::{Change, Operation},
    repetition::Repetition,
};
use crate::{
    Answer, Error,
    difference::{Align, Difference, End, Trace},
    print,
    story::open,
    why,
};

/// Arguments of `fork`.
#[derive(Clone, Debug, clap::Args)]
#[group(id = "when", required = true, multiple = false, args = ["tick", "at_failure"])]
pub struct Arguments {
    /// The log
    pub file: PathBuf,
    /// The last tick that is as in the log; 0 makes the changes before the first tick
    #[arg(long, value_name = "N")]
    pub tick: Option<u64>,
    /// Fork at the tick before the last command that led to the first failure
    #[arg(long)]
    pub at_failure: bool,
    /// What to change; may be given several times
    #[arg(long = "set", value_name = "CHANGE")]
    pub changes: Vec<Change>,
    /// Write the log of the fork into this file
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// What is compared with what
    #[arg(long, value_enum, default_value_t = Align::Command)]
    pub align: Align,
    #[command(flatten)]
    answer: Answer,
}

#[derive(Debug, Serialize)]
struct Forked {
    file: String,
    job: String,
    tick: u64,              // the last tick before the changes
    before: Option<String>, // with `--at-failure`: the command that the next tick begins
    set: Vec<String>,       // the changes of `--set`
    times_real_time: f64,   // simulated time divided by computing time
    outcome: [String; 2],
    seconds: [f64; 2],
    log: Option<PathBuf>,
    #[serde(flatten)]
    difference: Difference,
}

pub fn fork(arguments: &Arguments) -> Result<ExitCode, Error> {
    let log = open(&arguments.file)?;
    let failed = |source| Error::Fork { path: arguments.file.clone(), source: Box::new(source) };
    let command = match arguments.at_failure {
        true => Some(why::last_command(&log, &arguments.file)?.ok_or_else(|| failed(ForkError::NoFailure))?),
        false => None,
    };
    let given = command.as_ref().map(|command| command.tick.saturating_sub(1));
    let tick = arguments.tick.or(given).unwrap_or(0);
    let logged = Trace::of_log(&log, &arguments.file)?;
    let before_end = logged.end.ticks.saturating_sub(1);
    if tick > before_end {
        return Err(failed(ForkError::NoTick { tick, last: before_end }));
    }
    let started = Instant::now();
    let forked = run(&log, arguments, tick).map_err(failed)?;
    let answer = Forked {
        file: arguments.file.display().to_string(),
        job: log.run.get("job").cloned().unwrap_or_default(),
        tick,
        before: command.map(|link| format!("{} {}", link.process, link.text)),
        set: arguments.changes.iter().map(ToString::to_string).collect(),
        times_real_time: forked.end.seconds() / started.elapsed().as_secs_f64().max(1e-9),
        outcome: [logged.end.outcome.clone(), forked.end.outcome.clone()],
        seconds: [logged.end.seconds(), forked.end.seconds()],
        log: arguments.output.clone(),
        difference: Difference::between(&logged, &forked, arguments.align),
    };
    print(&answer, arguments.answer.json)?;
    Ok(ExitCode::SUCCESS)
}

/// Repeats the run of the log up to a tick, applies the changes, and continues to the end.
fn run(log: &Log, arguments: &Arguments, tick: u64) -> Result<Trace, ForkError> {
    let directory = tempfile::Builder::new().prefix("rcs-fork-").tempdir()?;
    let mut config = repeat::unpack(log, directory.path())?;
    let operations = prepare(log, &arguments.changes, tick, &config)?;
    let seed = config.seed;
    if let Some(output) = &arguments.output {
        check_output(output, Format::Mcap, [arguments.file.as_path()])
            .map_err(|source| ForkError::Output { path: output.clone(), source })?;
        let changes: Vec<String> = arguments.changes.iter().map(ToString::to_string).collect();
        config.remarks.extend(repeat::fork_remarks(tick, &changes));
        config.log = LogTarget::File(output.clone());
    }
    let mut run = Repetition::new(Run::new(config, Box::new(()))?);
    let is_other = arguments.changes.iter().any(|change| matches!(change, Change::Cell { .. }));
    for logged in log.ticks() {
        let logged = logged?;
        if logged.tick.0 > tick || is_other {
            break;
        }
        run.follow(&logged)?;
    }
    for operation in operations {
        operation.apply(&mut run.run, seed).map_err(|source| ForkError::Change { tick, source })?;
    }
    while run.step() {}
    let outcome = run.run.finish();
    run.trace.end = End::of_run(&outcome);
    Ok(run.trace)
}

/// Converts the changes to operations before the run begins, and writes a changed cell description.
fn prepare(
    log: &Log,
    changes: &[Change],
    tick: u64,
    config: &RunConfig,
) -> Result<Vec<Operation>, ForkError> {
    let cell = log.attachment(Attachment::CELL).ok_or(RepeatError::Missing("cell description"))?;
    let mut text = String::from_utf8_lossy(&cell.data).into_owned();
    for change in changes {
        let Change::Cell { key, .. } = change else { continue };
        if tick > 0 {
            return Err(ForkError::CellLater(key.clone()));
        }
        text = change.described(&text)?;
        fs::write(config.data.join(CELL), &text)?;
    }
    let description = change::description(&text)?;
    let all = generations(log)?;
    let at =
        log.ticks().take_while(|logged| logged.as_ref().is_ok_and(|logged| logged.tick.0 <= tick)).last();
    let generation = at.transpose()?.map_or(Ok(0), |logged| {
        let external: Result<ExternalInputs, _> = from_bytes(&logged.external);
        external.map(|external| external.generation).map_err(|_| ReadError::Damaged { tick })
    })?;
    let store = usize::try_from(generation).ok().and_then(|generation| all.get(generation));
    let store = store.ok_or(ReplayError::Generation { tick, generation })?;
    Ok(change::operations(changes, store, &description)?)
}

impl fmt::Display for Forked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { job, tick, times_real_time, .. } = self;
        match tick {
            0 => write!(f, "{job}, changed before its first tick")?,
            _ => {
                let seconds = *tick as f64 * TICK_S;
                write!(f, "{job} as logged up to tick {tick} ({seconds:.2} s), every bit compared")?;
            }
        }
        writeln!(f, "; {times_real_time:.0} x real time")?;
        if let Some(before) = &self.before {
            writeln!(f, "{:<10} {before}", "before")?;
        }
        self.set.iter().try_for_each(|change| writeln!(f, "{:<10} {change}", "changed"))?;
        if let Some(log) = &self.log {
            writeln!(f, "{:<10} {}", "log", log.display())?;
        }
        if self.difference.is_none() {
            return writeln!(f, "{:<10} nothing; both: {}", "different", self.outcome[0]);
        }
        if self.outcome[0] == self.outcome[1] {
            writeln!(f, "{:<10} both: {}", "outcome", self.outcome[0])?;
        }
        writeln!(f, "\nThe log, and then the fork:")?;
        self.difference.fmt(f)
    }
}
