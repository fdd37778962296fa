//! `rcs-run run`: runs a job, from the first tick to the result.

use std::{env, io, process::ExitCode, sync::Arc};

use clap::CommandFactory as _;
use diagnostics::{JOBS, UnknownFile, nearest};
use executive::memory::{OnTimeout, RunName};
use os_io::{carried::is_carried, stderr_line};
use runtime::{
    ClockKind, Ending, Observer, Run, RunConfig, RunOutcome, StartError,
    result::{FailureResult, RunResult},
};

use crate::rcs_run::{
    arguments::RunArguments,
    cli::Cli,
    console::Console,
    error::{Error, FAILED, STOPPED},
    interrupt::interruption,
    last_lines::LastLines,
    memory_fault,
    page::Page,
    progress::Progress,
};

const CONSOLE: &str = "console"; // name of a run with a console, followed by the number of the process

/// Run a job and print its result. Fails if the run could not begin. A failed job is not an error but an exit status.
pub fn run(arguments: &RunArguments) -> Result<ExitCode, Error> {
    let stop = interruption()?;
    let on_stuck = Some(memory_fault::stuck as OnTimeout);
    let console = arguments.console.then(Console::program).transpose()?;
    let name = arguments.run.clone().or_else(|| console.as_ref().map(|_| RunName::unique(CONSOLE)));
    let program = env::current_exe()?;
    let config =
        RunConfig { stop: Arc::clone(&stop), on_stuck, program, name: name.clone(), ..arguments.config() };
    // The console uses the terminal, so messages go to the log of the run.
    let observer: Box<dyn Observer> =
        if console.is_some() { Box::new(()) } else { Box::new(Progress::default()) };
    let is_at_port = config.robot.kind.lives_in_real_time() || config.has_real_devices();
    if is_at_port && arguments.data.is_none() && is_carried(&config.data) {
        return Err(Error::BuiltInAtPort);
    }
    if config.resume.is_some() && config.clock == ClockKind::Fast {
        return Err(StartError::ResumeStandBy.into());
    }
    let run = Run::new(config, observer).map_err(explained)?;
    if let Some(address) = run.live_address().filter(|_| arguments.open)
        && let Err(error) = os_io::browser::open(address.as_ref())
    {
        stderr_line!("rcs-run: no browser can be started: {error}; open {address} in one");
    }
    let console =
        console.zip(name).map(|(program, name)| Console::start(program, &name, stop)).transpose()?;
    let outcome = run.complete();
    if let Some(console) = console {
        console.wait();
    }
    print(&outcome, arguments.json)?;
    let status = status(&outcome);
    if !arguments.json {
        os_io::console::answer(&LastLines(&outcome).to_string())?;
    }
    Ok(ExitCode::from(status))
}

/// The error with which the start failed. A word that is nearer to a subcommand than to any job probably means the
/// subcommand.
fn explained(error: StartError) -> Error {
    if let StartError::NoFile(UnknownFile { what, name, known }) = &error
        && *what == JOBS.what
    {
        let program = Cli::command();
        let subcommands = program.get_subcommands().map(clap::Command::get_name);
        let near = nearest(name, known.iter().map(String::as_str).chain(subcommands));
        if let Some(near) = near.filter(|near| !known.iter().any(|job| job == near)) {
            return Error::Subcommand { word: name.clone(), subcommand: near.to_owned() };
        }
    }
    error.into()
}

fn print(outcome: &RunOutcome, json: bool) -> Result<(), Error> {
    if json {
        let text = serde_json::to_string(&outcome.result).map_err(io::Error::from)?;
        return Ok(os_io::console::json(&(text + "\n"))?);
    }
    Ok(os_io::console::answer(&Page(outcome).to_string())?)
}

/// The exit status; the reason is the last line on standard error.
fn status(outcome: &RunOutcome) -> u8 {
    if let Ending::StoppedByUser = outcome.ending {
        let RunResult { job, ticks, .. } = &outcome.result;
        stderr_line!("rcs-run: {job} was stopped by the user at tick {ticks}");
        return STOPPED;
    }
    let (Ending::Failed(account), Some(FailureResult { line, .. })) =
        (&outcome.ending, &outcome.result.failure)
    else {
        return 0;
    };
    let (job, tick) = (&outcome.result.job, account.first.tick);
    let line = line.as_ref().map_or_else(String::new, |line| format!(" in `{line}`"));
    let to_do = outcome.remedy.map_or_else(String::new, |remedy| format!("; to do: {remedy}"));
    stderr_line!("rcs-run: {job} failed at tick {tick}{line}: {account}{to_do}");
    if account.is_stopped() { STOPPED } else { FAILED }
}
