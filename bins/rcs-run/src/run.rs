//! `rcs-run run`: a job, from the first tick to the result.

use std::{env, io, process::ExitCode};

use executive::memory::OnStuck;
use os_io::{console, stderr_line};
use runtime::{Ending, Run, RunConfig, RunOutcome, result::FailureResult};

use crate::{
    cli::RunArguments,
    error::{Error, FAILED, STOPPED},
    interrupt::interruption,
    memory_fault,
    page::Page,
    progress::Progress,
};

/// Run a job and print its result.
///
/// # Errors
/// [`Error`] if the run could not begin. A job that fails is no error here, but an exit status.
pub fn run(arguments: &RunArguments) -> Result<ExitCode, Error> {
    let stop = interruption()?;
    let on_stuck = Some(memory_fault::stuck as OnStuck);
    let config = RunConfig { stop, on_stuck, program: env::current_exe()?, ..arguments.config() };
    let outcome = Run::new(config, Box::new(Progress::default()))?.complete();
    print(&outcome, arguments.json)?;
    Ok(ExitCode::from(status(&outcome)))
}

fn print(outcome: &RunOutcome, json: bool) -> Result<(), Error> {
    let text = if json {
        serde_json::to_string(&outcome.result).map_err(io::Error::from)? + "\n"
    } else {
        Page(outcome).to_string()
    };
    Ok(console::answer(&text)?)
}

/// The exit status; the reason is the last line on standard error.
fn status(outcome: &RunOutcome) -> u8 {
    let (Ending::Failed(failure), Some(FailureResult { line, .. })) =
        (&outcome.ending, &outcome.result.failure)
    else {
        return 0;
    };
    let (job, tick, text) = (&outcome.result.job, failure.tick, &failure.text);
    let line = line.as_ref().map_or_else(String::new, |line| format!(" in `{line}`"));
    let to_do = outcome.remedy.map_or_else(String::new, |remedy| format!("; to do: {remedy}"));
    stderr_line!("rcs-run: {job} failed at tick {tick}{line}: {text}{to_do}");
    if failure.stopped { STOPPED } else { FAILED }
}
