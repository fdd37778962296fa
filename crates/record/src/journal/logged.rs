//! The images of a log as knowledge, when the journal of its run is missing or cannot be used.

use std::{io::Read as _, path::Path};

use interfaces::{CommonMemory, ExternalInputs};
use os_io::files;
use rcs_core::{plain::from_bytes, tick::Tick};

use super::{
    doubt::RunEnd,
    format::{Contents, Entry, Identity},
    kept::kept,
};
use crate::{
    error::ReadError,
    lossless::Codecs,
    names::RESULT,
    part::Part,
    reader::{Log, LoggedTick},
    views::{Changes, JobState},
};

const STEP: usize = 4; // parts of a log from whose begin the last image is searched first: about two seconds

#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoggedError {
    #[error(transparent)]
    Read(#[from] ReadError),
    #[error("{0}: name the last log of the run")]
    Continued(Part),
    #[error("the log has no complete image: its run was stopped before its first tick")]
    Empty,
    #[error("the log has no image of tick {0}, the last one of the saved cell")]
    Short(Tick),
}

/// The knowledge in the last complete image of a log, or in that of tick `at`. `identity` is that of the log's run.
pub fn logged(log: &Log, identity: Identity, at: Option<Tick>) -> Result<Contents, LoggedError> {
    log.check_layout()?;
    if let Some(part @ Part::First { .. }) = log.part() {
        return Err(LoggedError::Continued(part));
    }
    let (last, is_cut_off) = image(log, at)?;
    let newest = entry(log, &last)?;
    let end = if is_cut_off { RunEnd::CutOff } else { RunEnd::Logged };
    Ok(Contents { identity, newest, sequence: 0, end })
}

fn entry(log: &Log, logged: &LoggedTick) -> Result<Entry, ReadError> {
    let damaged = |_| ReadError::Damaged { tick: logged.tick.0 };
    let external: ExternalInputs = from_bytes(&logged.external).map_err(damaged)?;
    let memory: CommonMemory = from_bytes(&logged.memory).map_err(damaged)?;
    let states = Changes::<JobState>::of(log);
    let job = states.at(logged.tick);
    let result = log.end.as_ref().and_then(|end| end.get(RESULT));
    Ok(Entry {
        tick: logged.tick,
        over: result.is_some_and(|result| result == FINISHED),
        line: job.map_or(0, |job| job.index),
        begun: job.is_some_and(|job| job.outcome == EXECUTING),
        generation: external.generation,
        hws: external.hws,
        memory: kept(&memory),
        ..Entry::default()
    })
}

/// Result of a run whose job has ended, and outcome of a step in progress.
const FINISHED: &str = "finished";
const EXECUTING: &str = "executing";

/// The image of tick `at`, or the last one that can be read. Also returns true if later ones are missing.
pub(super) fn image(log: &Log, at: Option<Tick>) -> Result<(LoggedTick, bool), LoggedError> {
    let codecs = Codecs::new();
    let mut back = STEP;
    loop {
        let first = log.parts().saturating_sub(back);
        let (mut found, mut is_damaged): (Option<(usize, LoggedTick)>, bool) = (None, false);
        let mut ticks = log.ticks_from(first, &codecs);
        while let Some(read) = ticks.advance() {
            match read {
                Ok((_, logged)) if at.is_some_and(|at| logged.tick > at) => break,
                Ok((part, logged)) => found = Some((part, logged.clone())),
                Err(_) => {
                    is_damaged = true;
                    break;
                }
            }
        }
        match (found, at) {
            (Some((_, found)), Some(at)) if found.tick == at => return Ok((found, false)),
            (Some((part, found)), None) => {
                let is_whole = log.complete && !is_damaged && !log.is_damaged_from(part);
                return Ok((found, !is_whole || has_lost_ticks(log)));
            }
            (Some(_), Some(at)) => return Err(LoggedError::Short(at)),
            (None, Some(at)) if first == 0 => return Err(LoggedError::Short(at)),
            (None, None) if first == 0 => return Err(LoggedError::Empty),
            (None, _) => back = back.saturating_mul(STEP),
        }
    }
}

/// True if the end of a log counts more lost ticks than its records, so that the last ticks of the run are missing.
fn has_lost_ticks(log: &Log) -> bool {
    let fact = |key: &str| log.end.as_ref().and_then(|end| end.get(key)).map_or("0", String::as_str);
    fact("lost_ticks") != fact("gaps")
}

/// True for a file that begins like a log.
#[must_use]
pub fn is_log(path: &Path) -> bool {
    let mut start = [0; mcap::MAGIC.len()];
    files::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == mcap::MAGIC
}
