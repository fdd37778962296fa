//! `rcs-log compare`: runs jobs with two data directories, in parallel, and reports the differences: rows, clearances,
//! times, outcome.

use std::{
    collections::BTreeSet,
    fmt,
    path::{Path, PathBuf},
    process::ExitCode,
};

use diagnostics::JOBS;
use interfaces::CommonMemory;
use os_io::text::amount;
use programs::pages::{data_directory, job};
use runtime::{LogTarget, Run, RunConfig, StartError};
use serde::Serialize;

use crate::{
    Answer, DIFFERENT, Error,
    difference::{Align, Difference, End, Trace},
    parallel, print,
    story::Moment,
};

/// Arguments of `compare`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// The old data directory
    #[arg(value_name = "DATA-OLD", value_parser = data_directory())]
    pub old: PathBuf,
    /// The other
    #[arg(value_name = "DATA-NEW", value_parser = data_directory())]
    pub new: PathBuf,
    /// The jobs [default: all of both directories]
    #[arg(value_name = "JOB", value_parser = job(), hide_possible_values = true)]
    pub jobs: Vec<String>,
    /// Seed of the cell's sensor noise and of the positions of delivered parts
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// What is compared with what
    #[arg(long, value_enum, default_value_t = Align::Command)]
    pub align: Align,
    #[command(flatten)]
    answer: Answer,
}

#[derive(Debug, Serialize)]
struct Comparison {
    jobs: Vec<OneJob>,
}

#[derive(Debug, Serialize)]
struct OneJob {
    job: String,
    same: bool, // true if both runs agree in everything that is compared
    outcome: [String; 2],
    seconds: [f64; 2],
    clearance: [String; 2],
    #[serde(flatten)]
    difference: Difference,
}

pub fn compare(arguments: &Arguments) -> Result<ExitCode, Error> {
    let Arguments { old, new, .. } = arguments;
    let mut names: BTreeSet<String> = arguments.jobs.iter().cloned().collect();
    if names.is_empty() {
        let both = [old, new].into_iter().flat_map(|data| JOBS.all(data));
        names.extend(both.filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned())));
    }
    if names.is_empty() {
        return Err(Error::NoJobs(old.clone(), new.clone()));
    }
    let runs: Vec<(&Path, &str)> =
        names.iter().flat_map(|job| [(old.as_path(), job.as_str()), (new, job)]).collect();
    let traces = parallel::each(&runs, |(data, job)| run(data, job, arguments.seed));
    let traces: Vec<Trace> = traces.into_iter().collect::<Result<_, _>>().map_err(|source| {
        let details = source.details();
        if !details.is_empty() {
            os_io::console::stderr_drawn(details.trim_end());
        }
        Error::Start { source: Box::new(source) }
    })?;
    let jobs = names.iter().zip(traces.chunks_exact(2)).map(|(job, traces)| {
        let [old, new] = [&traces[0], &traces[1]];
        let difference = Difference::between(old, new, arguments.align);
        let of = |say: fn(&End) -> String| [say(&old.end), say(&new.end)];
        OneJob {
            job: job.clone(),
            same: difference.is_none(),
            outcome: of(|end| end.outcome.clone()),
            seconds: [old.end.seconds(), new.end.seconds()],
            clearance: of(|end| end.clearance().to_owned()),
            difference,
        }
    });
    let comparison = Comparison { jobs: jobs.collect() };
    print(&comparison, arguments.answer.json)?;
    let same = comparison.jobs.iter().all(|job| job.same);
    Ok(ExitCode::from(if same { 0 } else { DIFFERENT }))
}

fn run(data: &Path, job: &str, seed: u64) -> Result<Trace, StartError> {
    let config = RunConfig { log: LogTarget::None, shared_memory: false, seed, ..RunConfig::new(data, job) };
    let mut run = Run::new(config, Box::new(()))?;
    let (mut trace, mut before) = (Trace::default(), CommonMemory::default());
    loop {
        let has_next = run.step();
        let after = *run.memory();
        let (tick, external) = (run.last_tick(), *run.external_inputs());
        trace.note(&Moment { tick, gap: 0, external, before, after, timing: None, world: None });
        before = after;
        if !has_next {
            break;
        }
    }
    trace.end = End::of_run(&run.finish());
    Ok(trace)
}

/// The distance in a clearance text, or the whole text, such as "none", if it has no distance.
fn inches(clearance: &str) -> &str {
    let distance = clearance.split_once(" by ").and_then(|(_, rest)| rest.split_once(" in "));
    distance.map_or(clearance, |(distance, _)| distance)
}

/// The value of both runs, or `was -> is` if they differ.
fn turned<T: fmt::Display + PartialEq>([was, is]: [T; 2]) -> String {
    if was == is { was.to_string() } else { format!("{was} -> {is}") }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let head = ["job", "time s", "clearance in", "apart in", "other rows", "outcome"];
        let mut table = vec![head.map(str::to_owned)];
        table.extend(self.jobs.iter().map(OneJob::row));
        let mut widths = [0; 6];
        for row in &table {
            for (width, cell) in widths.iter_mut().zip(row) {
                *width = cell.chars().count().max(*width);
            }
        }
        for row in &table {
            let cells = row.iter().zip(widths).map(|(cell, width)| format!("{cell:<width$}"));
            writeln!(f, "{}", cells.collect::<Vec<_>>().join("  ").trim_end())?;
        }
        for job in self.jobs.iter().filter(|job| !job.same) {
            write!(f, "\n{}, the old data, and then the new:\n{}", job.job, job.difference)?;
        }
        Ok(())
    }
}

impl OneJob {
    fn row(&self) -> [String; 6] {
        let (otherwise, late) = self.difference.changes.deciding();
        let rows = match (otherwise, late) {
            (0, 0) => "none".to_owned(),
            (0, late) => format!("none; {late} at other times"),
            (otherwise, _) => amount(otherwise, "process"),
        };
        let outcome = if self.outcome[0] == self.outcome[1] {
            self.outcome[0].clone()
        } else {
            turned([&self.outcome[0], &self.outcome[1]])
        };
        [
            self.job.clone(),
            turned(self.seconds.map(|seconds| format!("{seconds:.2}"))),
            turned([inches(&self.clearance[0]), inches(&self.clearance[1])]),
            format!("{:.2}", self.difference.changes.apart()),
            rows,
            outcome,
        ]
    }
}
