//! `rcs-log replay`: runs the control processes again on the recorded inputs, and compares every output bit for bit.

use std::{
    fmt,
    path::{Path, PathBuf},
    process::ExitCode,
};

use os_io::text::amount;
use rcs_core::tick::Tick;
use record::{Options, ReplayError, ReplayReport};
use serde::Serialize;
use taskdata::load::{Diagnostics, Store};

use crate::{Answer, DIFFERENT, Error, UNUSABLE, parallel, print};

/// Arguments of `replay`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// The logs
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// Task data to replay with, instead of those in the log
    #[arg(long, value_name = "DIR", value_parser = programs::pages::data_directory())]
    pub data: Option<PathBuf>,
    /// Begin at the last recorded snapshot of the states before this tick
    #[arg(long, value_name = "TICK")]
    pub from: Option<u64>,
    /// Last tick to compute
    #[arg(long, value_name = "TICK")]
    pub until: Option<u64>,
    #[command(flatten)]
    answer: Answer,
}

#[derive(Debug, Serialize)]
struct Outcome {
    logs: Vec<OneLog>,
}

#[derive(Debug, Serialize)]
struct OneLog {
    file: String,
    same: bool, // true if every computed tick is the same as recorded
    ticks: u64,
    /// Number of ticks that were not computed: the ticks in gaps, and the ticks from a gap to the next snapshot.
    skipped: u64,
    complete: bool,         // true if the log has its end record
    damage: Option<String>, // the reason why part of the log cannot be read
    times_real_time: f64,
    digest: Option<String>,
    difference: Option<String>, // the first difference
    error: Option<String>,      // the reason why the log was not replayed, with its path
}

impl OneLog {
    fn new(path: &Path, outcome: Result<ReplayReport, ReplayError>) -> Self {
        let file = path.display().to_string();
        match outcome {
            Ok(report) => Self {
                file,
                same: report.is_same(),
                ticks: report.ticks,
                skipped: report.skipped,
                complete: report.complete,
                damage: report.damage.clone(),
                times_real_time: report.speed(),
                digest: Some(report.digest.to_string()),
                difference: report.first_difference.as_ref().map(ToString::to_string),
                error: None,
            },
            Err(error) => Self {
                file,
                same: false,
                ticks: 0,
                skipped: 0,
                complete: false,
                damage: None,
                times_real_time: 0.0,
                digest: None,
                difference: None,
                error: Some(match &error {
                    ReplayError::Read(source) => source.of(path),
                    other => format!("{}: {other}", path.display()),
                }),
            },
        }
    }
}

pub fn replay(arguments: &Arguments) -> Result<ExitCode, Error> {
    let data = arguments.data.as_deref().map(|data| {
        let unusable =
            |report: Box<Diagnostics>| Error::Data { path: data.to_owned(), report: report.render(false) };
        Store::load(data).map(|(store, _)| store).map_err(unusable)
    });
    let options =
        Options { data: data.transpose()?, from: arguments.from.map(Tick), until: arguments.until.map(Tick) };
    let replay = |path: &PathBuf| OneLog::new(path, record::replay_with(path, &options));
    let outcome = Outcome { logs: parallel::each(&arguments.files, replay) };
    print(&outcome, arguments.answer.json)?;
    let worst = |log: &OneLog| match (log.same, &log.error) {
        (_, Some(_)) => UNUSABLE,
        (false, None) => DIFFERENT,
        (true, None) => 0,
    };
    let status = outcome.logs.iter().map(worst).max().unwrap_or(0);
    if status != 0 {
        let failed = outcome.logs.iter().filter(|log| !log.same).count();
        os_io::stderr_line!("rcs-log: {failed} of {} did not replay", amount(outcome.logs.len(), "log"));
    }
    Ok(ExitCode::from(status))
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for log in &self.logs {
            if let Some(error) = &log.error {
                writeln!(f, "not replayed: {error}")?;
                continue;
            }
            let verdict = if log.same { "same" } else { "DIFFERENT" };
            let end = if log.complete { "" } else { "; the log has no end" };
            let gaps = if log.skipped > 0 {
                format!("; {} skipped", amount(log.skipped, "tick"))
            } else {
                String::new()
            };
            writeln!(
                f,
                "{}: {verdict}, {}, {:.0} x real time{gaps}{end}",
                log.file,
                amount(log.ticks, "tick"),
                log.times_real_time
            )?;
            if let Some(damage) = &log.damage {
                writeln!(f, "  {damage}")?;
            }
            match &log.difference {
                Some(difference) => writeln!(f, "  {difference}")?,
                None if !log.same => writeln!(f, "  every tick is the same, but not the digest at the end")?,
                None => {}
            }
        }
        Ok(())
    }
}
