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
//! `--truth` draws disturbances of robot and parts ([`truth`]), `--random` ticks and series of interruptions. A tick
//! of a branch is a tick of a run ([`branch`]); the campaign uses only the interfaces of the control processes. See
//! docs/campaign.md.

mod arguments;
mod branch;
mod coverage;
mod disturbance;
mod harm;
mod interruption;
mod invariants;
mod journal;
mod known;
mod markdown;
mod motion;
mod operator;
mod outage;
mod parent;
mod past;
mod pool;
mod power;
mod random;
mod report;
mod runner;
mod script;
mod series;
mod story;
#[cfg(test)]
mod tests;
mod trial;
mod truth;
mod verdict;

use std::{fs, io, process::ExitCode};

use os_io::{console, replace::replace_text, shell};
use runtime::{
    StartError, field,
    judge::check_job,
    setup::{CellFile, TaskFiles},
};

pub use self::arguments::CampaignArguments;
use self::{
    branch::Facility,
    interruption::Kind,
    parent::{Parent, Ticks},
    pool::Plan,
    random::Draw,
    report::CampaignReport,
    runner::{CoveragePart, Runner},
    series::Series,
    trial::{NoObserver, Procedure, Until},
    verdict::{BranchResult, Verdict},
};
use crate::rcs_run::error::Error;

const EVERY: u64 = 23; // default number of ticks between two forks

/// Prints the results. Fails if data or arguments cannot be used, or if the undisturbed job does not finish.
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
        replace_text(path, &text).map_err(|source| Error::Write { path: path.clone(), source })?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Run the campaign of one job. Returns its column of the table, or `None` if it printed a single branch.
fn of_job(arguments: &CampaignArguments, job: &str) -> Result<Option<markdown::Column>, Error> {
    let facility = facility(arguments, job)?;
    let procedure =
        Procedure { recovery: arguments.recovery, tries: arguments.tries, until: arguments.judge };
    let parent = Parent::run(&facility)?;
    let (plans, judged, met) = match arguments.random {
        Some(branches) => {
            let draw = draw(arguments, &facility, &parent, procedure, branches)?;
            let runner = Runner::new(arguments, &facility, &parent, procedure, branches)?;
            let (plans, judged) = runner.draw(draw)?;
            (plans, judged, runner.finish())
        }
        None => {
            let plans = match arguments.truth {
                Some(branches) => truth::plans(&facility, &parent, procedure, branches, arguments.draw),
                None => plans(arguments, &facility, &parent, procedure)?,
            };
            if plans.is_empty() {
                return Err(Error::Campaign("no branch to run: expected at least one".to_owned()));
            }
            if let ([plan], false, None) = (&plans[..], arguments.json, arguments.truth) {
                tell(arguments, &facility, &parent, plan)?;
                return Ok(None);
            }
            let runner = Runner::new(arguments, &facility, &parent, procedure, plans.len())?;
            let judged = runner.run(&plans, CoveragePart::New)?;
            (plans, judged, runner.finish())
        }
    };
    let mut results: Vec<BranchResult> = judged.into_iter().map(|(result, _)| result).collect();
    for (plan, result) in plans.iter().zip(&mut results) {
        if plan.series.interruptions().len() > 1 && !matches!(result.verdict, Verdict::Done | Verdict::Apart)
        {
            let fork = pool::fork_at(&facility, plan.at)?;
            let smallest = random::smallest(&plan.series, |series| {
                trial::run(&facility, &parent, &fork, series, procedure, None, &mut NoObserver)
                    .map(|other| (other.verdict, &other.reason) == (result.verdict, &result.reason))
            })?;
            result.smallest = Some(smallest.to_string());
        }
    }
    let field = arguments
        .field
        .as_ref()
        .map_or_else(String::new, |field| format!(" --field {}", shell::word(field.to_string())));
    let called = format!("rcs-run campaign {} --seed {}{field}", shell::word(job), arguments.seed);
    let report = CampaignReport::new(&facility.job.name, called, &parent, &results, &met);
    if arguments.json {
        console::json(&report.json()?)?;
    } else {
        console::answer(&report.text())?;
    }
    Ok(Some(report.column()))
}

fn tell(
    arguments: &CampaignArguments,
    facility: &Facility,
    parent: &Parent,
    plan: &Plan,
) -> Result<(), Error> {
    let Plan { at, series, procedure } = plan;
    let fork = pool::fork_at(facility, *at)?;
    let mut story = story::Story::new(*at, arguments.around);
    let result = trial::run(facility, parent, &fork, series, *procedure, None, &mut story)?;
    console::answer(&story.told(&result))?;
    Ok(())
}

fn draw(
    arguments: &CampaignArguments,
    facility: &Facility,
    parent: &Parent,
    procedure: Procedure,
    branches: usize,
) -> Result<Draw, Error> {
    let (data, cell) = (&arguments.data, &facility.description);
    let kinds = arguments.interrupt.iter().map(|text| Kind::named(text, data, cell));
    let kinds = kinds.collect::<Result<Vec<_>, _>>()?.concat();
    check_outages(facility, kinds.iter())?;
    let settings =
        random::Settings { branches, longest: usize::from(arguments.longest), seed: arguments.draw };
    Ok(Draw::new(parent, &kinds, procedure, settings))
}

fn plans(
    arguments: &CampaignArguments,
    facility: &Facility,
    parent: &Parent,
    procedure: Procedure,
) -> Result<Vec<Plan>, Error> {
    let (data, cell) = (&arguments.data, &facility.description);
    let series = arguments.interrupt.iter().map(|text| Series::named(text, data, cell));
    let series = series.collect::<Result<Vec<_>, _>>()?.concat();
    let kinds = series.iter().flat_map(Series::interruptions).map(|interruption| &interruption.kind);
    check_outages(facility, kinds)?;
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

fn check_outages<'k>(facility: &Facility, mut kinds: impl Iterator<Item = &'k Kind>) -> Result<(), Error> {
    let refused = kinds.find_map(|kind| kind.outage()?.refusal(facility.mapping.as_deref()));
    refused.map_or(Ok(()), |refused| Err(Error::Campaign(refused)))
}

fn facility(arguments: &CampaignArguments, job: &str) -> Result<Facility, Error> {
    let data = &arguments.data;
    let mut files = TaskFiles::load(data, Some(job), false)?;
    let CellFile { description, .. } = CellFile::load(data, &mut files, false)?;
    let TaskFiles { store, job, .. } = files;
    check_job(&job, &store, None)?;
    let mapping = match &arguments.field {
        Some(field) if !field.is_simulated => {
            let why = format!("--field {field}: a campaign runs in simulated time: expected sim:NAME");
            return Err(Error::Campaign(why));
        }
        Some(field) => {
            let (mapping, _) = field::load(field, data)?;
            field::check_job(&mapping, &job)?;
            Some(mapping)
        }
        None => None,
    };
    Ok(Facility::new(store, job, description, arguments.seed).with_mapping(mapping))
}

fn ticks(arguments: &CampaignArguments) -> Ticks {
    match (arguments.ticks, arguments.changes) {
        _ if !arguments.at.is_empty() => Ticks::At(arguments.at.clone()),
        (Some(every), true) => Ticks::Both(every),
        (None, true) => Ticks::Changes,
        _ if arguments.states => Ticks::States,
        _ if arguments.outputs.is_some() => Ticks::Outputs(arguments.outputs.unwrap_or(1)),
        (every, false) => Ticks::Every(every.unwrap_or(EVERY)),
    }
}
