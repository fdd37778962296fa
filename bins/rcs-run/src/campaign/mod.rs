//! `rcs-run campaign`: interrupts a job at many ticks, follows the operator's recovery procedure, and judges each
//! branch.
//!
//! ```text
//!   undisturbed run:  ──●────●────●────●────●──►     once to list the ticks and the world after each line, once to fork
//!                       │    │    │
//!                       ▼    ▼    ▼   a fork: cell, processes, common memory, mailboxes, line, Data System
//!                   interruption ──► PAUSE, the same command, up to three tries ──► next command ──► verdict
//! ```
//!
//! With `--random`, ticks and series of interruptions are drawn. A tick of a branch does what a tick of a run does
//! ([`branch`]); the campaign knows the control processes only by their interfaces. docs/campaign.md describes the
//! verdicts.

mod arguments;
mod branch;
mod harm;
mod interruption;
mod invariants;
mod journal;
mod markdown;
mod motion;
mod operator;
mod parent;
mod pool;
mod random;
mod report;
mod rows;
mod series;
mod story;
#[cfg(test)]
mod tests;
mod trial;

use std::{
    fs,
    io::{self, IsTerminal as _},
    process::ExitCode,
    time::Duration,
};

use indicatif::{ProgressBar, ProgressStyle};
use os_io::console;
use runtime::{
    StartError,
    setup::{CellFile, TaskFiles},
};

pub use self::arguments::CampaignArguments;
use self::{
    branch::Facility,
    interruption::Kind,
    journal::Journal,
    parent::{Parent, Ticks},
    pool::{Outcome, Plan},
    random::Draw,
    report::CampaignReport,
    rows::RowsFired,
    series::Series,
    trial::{BranchResult, NoObserver, Procedure, Until, Verdict},
};
use crate::error::Error;

/// Default number of ticks between two forks.
const EVERY: u64 = 23;

/// Run a campaign and print the results.
///
/// # Errors
/// [`Error`] if data or arguments cannot be used, or if the undisturbed job does not finish.
pub fn campaign(arguments: &CampaignArguments) -> Result<ExitCode, Error> {
    let mut columns = Vec::new();
    for job in &arguments.jobs {
        columns.extend(of_job(arguments, job)?);
    }
    if let Some(path) = &arguments.markdown {
        let page = match fs::read_to_string(path) {
            Ok(page) => Some(page),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(source) => return Err(StartError::Read { path: path.clone(), source }.into()),
        };
        let text = markdown::page(page.as_deref(), &columns).map_err(Error::Campaign)?;
        fs::write(path, text).map_err(|source| Error::Write { path: path.clone(), source })?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Run the campaign of one job. Returns its column of the table, or `None` if it printed a single branch.
fn of_job(arguments: &CampaignArguments, job: &str) -> Result<Option<markdown::Column>, Error> {
    let facility = facility(arguments, job)?;
    let procedure =
        Procedure { recovery: arguments.recovery, tries: arguments.tries, until: arguments.judge };
    let parent = Parent::run(&facility)?;
    let plans = plans(arguments, &facility, &parent, procedure)?;
    if let ([Plan { at, series, .. }], false) = (&plans[..], arguments.json) {
        let fork = pool::fork_at(&facility, *at)?;
        let mut story = story::Story::new(*at, arguments.around);
        let result = trial::run(&facility, &parent, &fork, series, procedure, &mut story)?;
        console::answer(&story.told(&result))?;
        return Ok(None);
    }
    let mut outcome = branches(arguments, &facility, &parent, procedure, &plans)?;
    for (plan, result) in plans.iter().zip(&mut outcome.results) {
        if plan.series.interruptions().len() > 1 && !matches!(result.verdict, Verdict::Done | Verdict::Apart)
        {
            let fork = pool::fork_at(&facility, plan.at)?;
            let smallest = random::smallest(&plan.series, |series| {
                trial::run(&facility, &parent, &fork, series, procedure, &mut NoObserver)
                    .map(|other| (other.verdict, &other.reason) == (result.verdict, &result.reason))
            })?;
            result.smallest = Some(smallest.to_string());
        }
    }
    let called = format!("rcs-run campaign {job} --seed {}", arguments.seed);
    let report = CampaignReport::new(&facility.job.name, called, &parent, &outcome);
    console::answer(&if arguments.json { report.json()? } else { report.text() })?;
    Ok(Some(report.column()))
}

/// Run the branches that the journal does not contain, and return the results of all.
fn branches(
    arguments: &CampaignArguments,
    facility: &Facility,
    parent: &Parent,
    procedure: Procedure,
    plans: &[Plan],
) -> Result<Outcome, Error> {
    let journal = match &arguments.journal {
        Some(path) => Journal::open(path, &journal::campaign(facility, parent, procedure))?,
        None => Journal::default(),
    };
    let missing: Vec<Plan> = plans.iter().filter(|plan| journal.result(plan).is_none()).cloned().collect();
    let bar = bar(plans.len(), plans.len() - missing.len());
    let done = |result: &BranchResult, fresh: &RowsFired| {
        if let Some(bar) = &bar {
            bar.inc(1);
            if result.verdict == Verdict::Hurt {
                bar.println(format!("hurt: {} at {}: {}", result.interruption, result.at, result.detail));
            }
        }
        journal.write(result, fresh)
    };
    let Outcome { results, mut rows } =
        pool::run(facility, parent, &missing, usize::from(arguments.threads), &done)?;
    if let Some(bar) = &bar {
        bar.finish_and_clear();
    }
    let mut run = results.into_iter();
    let results = plans.iter().map(|plan| journal.result(plan).cloned().or_else(|| run.next()));
    let results = results.collect::<Option<_>>().unwrap_or_default();
    rows.take_in(journal.into_rows());
    Ok(Outcome { results, rows })
}

/// The branches that the arguments ask for.
fn plans(
    arguments: &CampaignArguments,
    facility: &Facility,
    parent: &Parent,
    procedure: Procedure,
) -> Result<Vec<Plan>, Error> {
    let (data, cell) = (&arguments.data, &facility.description);
    if let Some(branches) = arguments.random {
        let kinds = arguments.interrupt.iter().map(|text| Kind::named(text, data, cell));
        let kinds = kinds.collect::<Result<Vec<_>, _>>()?.concat();
        let draw = Draw { branches, longest: usize::from(arguments.longest), seed: arguments.draw };
        return Ok(draw.plans(parent, &kinds, procedure));
    }
    let series = arguments.interrupt.iter().map(|text| Series::named(text, data, cell));
    let series = series.collect::<Result<Vec<_>, _>>()?.concat();
    let stops = |series: &Series| series.interruptions().last().is_some_and(|last| last.kind.is_stop());
    if let (Until::Rest, Some(other)) = (procedure.until, series.iter().find(|series| !stops(series))) {
        return Err(Error::Campaign(format!(
            "--judge rest: expected pause, hold, estop, cut or lost:PROCESS as the last interruption, found {other}"
        )));
    }
    let forks = parent.forks(&ticks(arguments));
    if forks.is_empty() {
        let ticks = parent.ticks;
        return Err(Error::Campaign(format!("no tick to fork at: the job has ticks 1 to {}", ticks - 1)));
    }
    let of = |series: &Series| {
        let plan = |at: &u64| Plan { at: *at, series: series.clone(), procedure };
        forks.iter().map(plan).collect::<Vec<_>>()
    };
    Ok(series.iter().flat_map(of).collect())
}

fn facility(arguments: &CampaignArguments, job: &str) -> Result<Facility, Error> {
    let data = &arguments.data;
    let TaskFiles { store, job, job_path, .. } = TaskFiles::load(data, Some(job))?;
    let CellFile { description, .. } = CellFile::load(data, &store, &job, &job_path)?;
    Ok(Facility { store, job, description, seed: arguments.seed })
}

fn ticks(arguments: &CampaignArguments) -> Ticks {
    match (arguments.ticks, arguments.changes) {
        _ if !arguments.at.is_empty() => Ticks::At(arguments.at.clone()),
        (Some(every), true) => Ticks::Both(every),
        (None, true) => Ticks::Changes,
        _ if arguments.states => Ticks::States,
        (every, false) => Ticks::Every(every.unwrap_or(EVERY)),
    }
}

/// The progress bar on a terminal; `None` if standard error is not a terminal.
fn bar(branches: usize, known: usize) -> Option<ProgressBar> {
    io::stderr().is_terminal().then(|| {
        let bar = ProgressBar::new(branches as u64).with_position(known as u64).with_elapsed(Duration::ZERO);
        if let Ok(style) =
            ProgressStyle::with_template("{wide_bar} {pos}/{len} branches, {per_sec}, {eta} left")
        {
            bar.set_style(style);
        }
        bar
    })
}
