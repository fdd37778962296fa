//! `rcs-run status`: prints the state of a run in progress, read from its shared memory.

use std::{fmt, process::ExitCode};

use executive::{
    boards,
    memory::{self, Attached, OnTimeout, RunName, SET_UP_LIMIT, SharedMemoryError, mirror, within_limit},
    status::Status,
};

use os_io::console;
use serde::Serialize;

use crate::rcs_run::{answer::answer, arguments::StatusArguments, error::Error, memory_fault::stuck};

/// Read the state of a run, and print it.
pub fn status(arguments: &StatusArguments) -> Result<ExitCode, Error> {
    let name = match &arguments.run {
        Some(name) => name.clone(),
        None => only_run()?,
    };
    if let Some(phase) = memory::starting(&name) {
        answer(&Starting::of(&name, phase), arguments.json)?;
        return Ok(ExitCode::SUCCESS);
    }
    let run = within_limit(SET_UP_LIMIT, Some(stuck as OnTimeout), || Attached::open(&name))?;
    if arguments.directory {
        console::answer(&format!("{}\n", mirror::directory(&name).display()))?;
        return Ok(ExitCode::SUCCESS);
    }
    let status = Status::of(name.as_str(), &run.external()?, &run.memory()?, &run.pulse()?);
    let phase = memory::phase(&name).filter(|phase| phase != "runs");
    answer(&Status { phase, ..status }, arguments.json)?;
    Ok(ExitCode::SUCCESS)
}

#[derive(Serialize)]
struct Starting {
    run: String,
    phase: String,
    /// Boards that have not joined yet.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    missing_boards: Vec<u8>,
}

impl Starting {
    fn of(name: &RunName, phase: String) -> Self {
        let boards = boards::coming_up(name).unwrap_or_default();
        let missing = boards.iter().filter(|(_, is_there)| !is_there);
        Self {
            run: name.to_string(),
            phase,
            missing_boards: missing.map(|(board, _)| board.number()).collect(),
        }
    }
}

impl fmt::Display for Starting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.run, self.phase)?;
        for (at, board) in self.missing_boards.iter().enumerate() {
            write!(f, "{} {board}", if at == 0 { "; missing: board" } else { "," })?;
        }
        writeln!(f)
    }
}

/// The run in progress, if there is exactly one. Fails with [`Error::SharedMemory`] or [`Error::WhichRun`].
pub fn only_run() -> Result<RunName, Error> {
    let alive: Vec<_> = memory::list()?.into_iter().filter(|run| run.alive).map(|run| run.name).collect();
    match &alive[..] {
        [only] => Ok(only.clone()),
        [] => Err(SharedMemoryError::NoSuchRun { run: None, alive }.into()),
        several => Err(Error::WhichRun(several.iter().map(ToString::to_string).collect())),
    }
}
