//! Tries new data before they are written, with the checks and with runs in the simulated cell.

use std::{panic::resume_unwind, path::Path, thread};

use diagnostics::JOBS;
use runtime::{Ending, LogTarget, Run, RunConfig, result::FailureResult};
use tempfile::TempDir;

use super::change::Change;
use crate::rcs_run::{check, error::Error};

const SEEDS: [u64; 3] = [1, 2, 3]; // seeds for the runs of a new job
const AT_A_TIME: usize = 2; // number of simultaneous runs

pub struct Trial {
    place: TempDir,
    pub warnings: Vec<String>,
}

impl Trial {
    /// Copy and check the data. Only warnings that contain `name` are returned.
    pub fn checked(change: &Change, name: &str) -> Result<Self, Error> {
        let place = tempfile::tempdir()?;
        change.copy_to(place.path())?;
        let (errors, mut warnings) = check::findings(place.path());
        if !errors.is_empty() {
            // The copy no longer exists when the user reads the message.
            let copy = format!("{}/", place.path().display());
            let errors = errors.join("\n  ").replace(&copy, "");
            return Err(Error::New(format!("check finds errors:\n  {errors}")));
        }
        warnings.retain(|warning| warning.contains(name));
        Ok(Self { place, warnings })
    }

    pub fn data(&self) -> &Path {
        self.place.path()
    }

    /// Run the new job with several seeds and, if `others`, every other job once. Returns the number of finished runs.
    pub fn run(&self, job: &str, others: bool) -> Result<usize, Error> {
        let mut wanted: Vec<(String, u64)> = SEEDS.map(|seed| (job.to_owned(), seed)).into();
        let all = JOBS.all(self.data()).into_iter().filter(|_| others);
        let names = all.filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned()));
        wanted.extend(names.filter(|name| name != job).map(|name| (name, 1)));
        for some in wanted.chunks(AT_A_TIME) {
            thread::scope(|scope| {
                let runs: Vec<_> =
                    some.iter().map(|(job, seed)| scope.spawn(move || self.finishes(job, *seed))).collect();
                runs.into_iter().try_for_each(|run| run.join().unwrap_or_else(|panic| resume_unwind(panic)))
            })?;
        }
        Ok(wanted.len())
    }

    fn finishes(&self, job: &str, seed: u64) -> Result<(), Error> {
        let config = RunConfig {
            seed,
            log: LogTarget::None,
            shared_memory: false,
            ..RunConfig::new(self.data(), job)
        };
        let outcome = Run::new(config, Box::new(()))?.complete();
        let Ending::Failed(account) = &outcome.ending else {
            return if outcome.is_finished() {
                Ok(())
            } else {
                Err(Error::New(format!("the trial run of {job} was stopped")))
            };
        };
        let line = outcome.result.failure.as_ref().and_then(|FailureResult { line, .. }| line.as_ref());
        let line = line.map_or_else(String::new, |line| format!(" in `{line}`"));
        let tick = account.first.tick;
        Err(Error::New(format!(
            "the trial run of {job} with seed {seed} fails at tick {tick}{line}: {account}"
        )))
    }
}
