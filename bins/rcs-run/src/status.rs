//! `rcs-run status`: prints the state of a run in progress, read from its shared memory.

use std::process::ExitCode;

use executive::{
    memory::{self, Attached, OnStuck, RunName, SET_UP_LIMIT, SharedMemoryError, mirror, within_limit},
    status::Status,
};

use os_io::console;

use crate::{answer, cli::StatusArguments, error::Error, memory_fault::stuck};

/// Read the state of a run, and print it.
///
/// # Errors
/// [`Error::SharedMemory`] if there is no such run or it cannot be read; [`Error::WhichRun`] if there are several and
/// none is named.
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

/// The run in progress, if there is exactly one.
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
