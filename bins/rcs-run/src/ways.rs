//! The motions of jobs and stored routes, simulated before the robot moves ([`paths`]), and `check --explain-job`.

use std::{panic::resume_unwind, path::Path, process::ExitCode, thread};

use diagnostics::{At, Diagnostics, JOBS, Problems, Source};
use os_io::console;
use paths::{
    finding::Segment,
    job::{JobLine, NOT_CHECKED, WalkedJob, walk_job},
    known::Known,
    stored::walk_stored,
    walk::seconds,
};
use plant::{CellDescription, room::Room};
use runtime::{StartError, setup::CELL};
use serde::Serialize;
use taskdata::load::{Job, Store};

use crate::rcs_run::{
    answer::answer_long_json,
    arguments::CheckArguments,
    error::{Error, UNUSABLE},
};

/// The findings in the motions of jobs and in the stored routes. `known`: motions already simulated in the same cell.
pub fn of_all(
    jobs: &[Job],
    store: &Store,
    cell: &CellDescription,
    known: &Known,
) -> (Vec<Diagnostics>, Diagnostics) {
    let room = &Room::new(cell);
    thread::scope(|scope| {
        let stored = scope.spawn(move || of_stored(store, room, known));
        let walks: Vec<_> = jobs
            .iter()
            .map(|job| scope.spawn(move || of_job(job, &walk_job(job, store, room, known))))
            .collect();
        let jobs = walks.into_iter().map(|walk| walk.join().unwrap_or_else(|panic| resume_unwind(panic)));
        let jobs = jobs.collect();
        (jobs, stored.join().unwrap_or_else(|panic| resume_unwind(panic)))
    })
}

fn of_job(job: &Job, walked: &WalkedJob) -> Diagnostics {
    let mut problems = Problems::default();
    for finding in &walked.findings {
        let at = line(job.source(), finding.line);
        if finding.error {
            problems.error(finding.code, at, finding.message.clone());
            if let Some(help) = &finding.help {
                problems.help(help.clone());
            }
        } else {
            problems.warning(finding.code, at, finding.message.clone(), finding.help.clone());
        }
        problems.same_as(finding.key.clone());
        problems.about(finding.data.iter().map(|datum| datum.name.clone()).collect());
    }
    Diagnostics::of_file(problems, job.source())
}

fn of_stored(store: &Store, room: &Room, known: &Known) -> Diagnostics {
    let mut problems = Problems::default();
    for finding in walk_stored(store, room, known).findings {
        problems.error("path.stored", finding.at, finding.message);
    }
    Diagnostics::new(problems, store.places(), 0, Vec::new())
}

fn line(source: &Source, number: u32) -> At {
    let before = usize::try_from(number).unwrap_or(1).saturating_sub(1);
    let start: usize = source.text.split_inclusive('\n').take(before).map(str::len).sum();
    let length = source.text.get(start..).and_then(|rest| rest.lines().next()).map_or(0, str::len);
    let short = |number: usize| u32::try_from(number).unwrap_or(u32::MAX);
    At { source: 0, start: short(start), length: short(length) }
}

#[derive(Serialize)]
struct Explained<'a> {
    #[serde(flatten)]
    job: &'a WalkedJob,
    never_checked: [&'static str; NOT_CHECKED.len()],
}

/// Print all lines of a job with their motions. Exit status 2 if a motion is missing or impossible.
pub fn explain(arguments: &CheckArguments, name: &str) -> Result<ExitCode, Error> {
    let unusable = |what: String| move |report: Box<Diagnostics>| StartError::Data { what, report };
    let data = &arguments.data;
    let (store, _) =
        Store::load(data).map_err(unusable(format!("the task data under {}", data.display())))?;
    let path = JOBS.find(Path::new(name), data).map_err(StartError::from)?;
    let (job, _) = Job::load(&path, &store).map_err(unusable(format!("the job {}", path.display())))?;
    let cell = cell(data)?;
    let walked = walk_job(&job, &store, &Room::new(&cell), &Known::default());
    if arguments.json {
        answer_long_json(&Explained { job: &walked, never_checked: NOT_CHECKED })?;
    } else {
        console::answer(&in_words(&walked))?;
    }
    let missing = |line: &JobLine| line.phases.iter().any(|phase| phase.plan.missing.is_some());
    let failed = walked.findings.iter().any(|finding| finding.error) || walked.lines.iter().any(missing);
    Ok(ExitCode::from(if failed { UNUSABLE } else { 0 }))
}

fn cell(data: &Path) -> Result<CellDescription, Error> {
    let path = data.join(CELL);
    CellDescription::load(&path).map_err(|error| Error::Explain(format!("{}: {error}", path.display())))
}

fn in_words(walked: &WalkedJob) -> String {
    let mut text = format!("{}\n", walked.job);
    for line in &walked.lines {
        text += &format!("\n{:>3}  {}\n", line.line, line.text);
        if line.tried > 1 {
            text += &format!("     tried with the part in {} places and attitudes\n", line.tried);
        }
        for phase in &line.phases {
            text += &match phase.plan.ticks() {
                0 => format!("     {}\n", phase.plan.what),
                ticks => format!("     {:<72} {:6.2} s\n", phase.plan.what, seconds(ticks)),
            };
            if let Some(missing) = &phase.plan.missing {
                text += &format!("         MISSING {missing}\n");
            }
            for (segment, leg) in phase.segments.iter().zip(&phase.plan.legs) {
                text += &in_a_row(segment, seconds(leg.ticks));
            }
        }
        text += &match &line.holds {
            Some(held) => format!("     holds {held}\n"),
            None => "     holds nothing\n".to_owned(),
        };
        text += &format!("     {:.2} s of motion\n", seconds(line.ticks()));
    }
    let ticks = walked.lines.iter().map(JobLine::ticks).sum();
    text +=
        &format!("\n{:.2} s of motion at full speed, without fingers, camera and pedestal\n", seconds(ticks));
    if let Some(nearest) = walked.nearest() {
        text += &format!("closest: {nearest}\n");
    }
    for finding in &walked.findings {
        let word = if finding.error { "ERROR" } else { "WARNING" };
        text += &format!("{word} line {}: {}\n", finding.line, finding.message);
        if let Some(help) = &finding.help {
            text += &format!("      {help}\n");
        }
    }
    text += "not checked:\n";
    for what in walked.not_checked.iter().map(String::as_str).chain(NOT_CHECKED) {
        text += &format!("  {what}\n");
    }
    text
}

fn in_a_row(segment: &Segment, seconds: f64) -> String {
    let Segment { part, from, to, joint, margin_deg, nearest, .. } = segment;
    let nearest = nearest.as_ref().map_or_else(
        || "nothing within 2.00 in".to_owned(),
        |near| format!("{} {:.2} in from {}", near.mover, near.clearance_in, near.obstacle),
    );
    format!(
        "       {part:<11}{from:<10} {to:<10} {seconds:6.2} s  {joint:<8} {margin_deg:6.1} deg  {nearest}\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_is_found_by_its_number() {
        let source = Source { name: "j".to_owned(), text: "one\n\nthree\n".into() };
        assert_eq!((line(&source, 1).start, line(&source, 1).length), (0, 3));
        assert_eq!((line(&source, 3).start, line(&source, 3).length), (5, 5));
        assert_eq!(line(&source, 9).length, 0);
    }
}
