//! `rcs-run status`: what a run that goes on is doing, read from its shared memory.

use std::process::ExitCode;

use executive::{
    memory::{self, Attached, OnStuck, RunName, SET_UP_LIMIT, SharedMemoryError, mirror, within_limit},
    status::Status,
};

use os_io::console;

use crate::{answer, cli::StatusArguments, error::Error, memory_fault::stuck};

/// Look at a run and print.
///
/// # Errors
/// [`Error::SharedMemory`] if there is no such run, or it cannot be read; [`Error::WhichRun`] if there are several
/// and none was named.
pub fn status(arguments: &StatusArguments) -> Result<ExitCode, Error> {
    let name = match &arguments.run {
        Some(name) => name.clone(),
        None => only_run()?,
    };
    let run = within_limit(SET_UP_LIMIT, Some(stuck as OnStuck), || Attached::open(&name))?;
    if arguments.directory {
        console::answer(&format!("{}\n", mirror::directory(&name).display()))?;
        return Ok(ExitCode::SUCCESS);
    }
    let status = Status::of(name.as_str(), &run.external()?, &run.memory()?, &run.pulse()?);
    answer(&status, arguments.json)?;
    Ok(ExitCode::SUCCESS)
}

/// The run that goes on, if there is one only.
///
/// # Errors
/// [`Error::SharedMemory`], [`Error::WhichRun`].
pub fn only_run() -> Result<RunName, Error> {
    let alive: Vec<_> = memory::list()?.into_iter().filter(|run| run.alive).map(|run| run.name).collect();
    match &alive[..] {
        [only] => Ok(only.clone()),
        [] => Err(SharedMemoryError::NoSuchRun { run: None, alive }.into()),
        several => Err(Error::WhichRun(several.iter().map(ToString::to_string).collect())),
    }
}
