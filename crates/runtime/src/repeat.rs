//! Repeats a recorded run, with the configuration from its log.
//!
//! A log contains all that a run with the simulated robot depends on: task data, job and the blocks that it loads,
//! cell description, faults; seed, retries and limits. [`unpack`] writes the files and returns the configuration. The
//! clock is the fast one: if the run missed no slots, the repetition is equal bit for bit.

use std::{
    collections::BTreeMap,
    fs, io,
    path::{Component, Path, PathBuf},
};

use record::{Attachment, Log, Part};

use crate::{
    config::{FieldConfig, LogTarget, RobotConfig, RunConfig},
    log::{
        DATA, DATA_BASE, FAULTS, FIELD, IN_MEMORY, LOADS, MAPPING, OUTSIDE, RETRY, STAND_BY, TICKS, UNCHECKED,
    },
    setup::{CELL, EXTENSION},
};

/// Key of the metadata: the last tick in which a fork is equal to its log.
pub const FORKED_AFTER: &str = "forked_after";
pub const CHANGES: &str = "changes";

#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RepeatError {
    /// The log lacks data that a run needs.
    #[error(
        "the log has no {0}, which a run needs: rcs-run of this version writes it; run the job again to get such a log"
    )]
    Missing(&'static str),
    /// The log lacks the actions of a participant of the run.
    #[error(
        "{0} took part in the run, and its actions are not in the log: only a run that is simulated whole can be repeated"
    )]
    Elsewhere(String),
    #[error("a fork needs the log of a whole run, without --log-limit: {0}")]
    Part(Part),
    #[error(
        "the log is that of a fork, after tick {tick} with {changes}: fork the log that it came from, with all changes"
    )]
    Fork {
        tick: String, // the last tick in which the fork is equal to its log
        changes: String,
    },
    /// A file name of the log leads out of the directory.
    #[error(
        "the log holds a file named {0}, which leads out of its directory: a name without .. and / was expected"
    )]
    Name(String),
    #[error("{} cannot be written: {source}", path.display())]
    Write { path: PathBuf, source: io::Error },
}

/// Writes a log's files into an empty directory. Fails if the log does not contain the whole run.
pub fn unpack(log: &Log, directory: &Path) -> Result<RunConfig, RepeatError> {
    if let Some(part) = log.part() {
        return Err(RepeatError::Part(part));
    }
    let said = |key: &str| log.run.get(key).map(String::as_str);
    if let Some(tick) = said(FORKED_AFTER) {
        let changes = said(CHANGES).unwrap_or_default().to_owned();
        return Err(RepeatError::Fork { tick: tick.to_owned(), changes });
    }
    if let Some(outside) = said(OUTSIDE).filter(|outside| !outside.is_empty()) {
        return Err(RepeatError::Elsewhere(format!("{outside} in another process")));
    }
    if said(DATA_BASE).is_some_and(|place| place != IN_MEMORY) {
        return Err(RepeatError::Elsewhere("a database in a file".to_owned()));
    }
    let robot = said("robot").ok_or(RepeatError::Missing("robot"))?;
    let robot: RobotConfig =
        robot.parse().map_err(|_| RepeatError::Elsewhere(format!("the robot {robot}")))?;
    if robot.kind.lives_in_real_time() {
        return Err(RepeatError::Elsewhere(format!("the robot {robot}")));
    }
    let field: Option<FieldConfig> = said(FIELD).and_then(|field| field.parse().ok());
    if let Some(field) = field.as_ref().filter(|field| !field.is_simulated) {
        return Err(RepeatError::Elsewhere(format!("the devices of {}", field.mapping.display())));
    }
    let number = |key| said(key).and_then(|number| number.parse::<u64>().ok());
    let name = said("job").ok_or(RepeatError::Missing("job"))?;
    let (data, jobs) = (directory.join("data"), directory.join("job"));
    for attachment in &log.attachments {
        if let Some(name) = attachment.name.strip_prefix(Attachment::TASK_DATA) {
            write(&data, name, attachment)?;
        } else if let Some(name) = attachment.name.strip_prefix(LOADS) {
            write(&jobs, name, attachment)?;
        }
    }
    let cell = log.attachment(Attachment::CELL).ok_or(RepeatError::Missing("cell description"))?;
    write(&data, CELL, cell)?;
    let job = log.attachment(Attachment::JOB).ok_or(RepeatError::Missing("job"))?;
    let job = write(&jobs, &format!("{name}.{EXTENSION}"), job)?;
    // A run on stand-by waits for the inputs of its log, even if there are none.
    let stand_by = said(STAND_BY).is_some();
    let operated = stand_by || log.operator_lines().next().is_some();
    let faults = log.attachment(FAULTS).map(|faults| write(directory, FAULTS, faults)).transpose()?;
    let mapping =
        field.map(|_| log.attachment(MAPPING).ok_or(RepeatError::Missing("mapping"))).transpose()?;
    let mapping = mapping.map(|mapping| write(directory, MAPPING, mapping)).transpose()?;
    Ok(RunConfig {
        robot,
        field: mapping.map(FieldConfig::simulated),
        faults,
        seed: number("seed").ok_or(RepeatError::Missing("seed"))?,
        ticks: number(TICKS),
        retry: number(RETRY).and_then(|retry| u32::try_from(retry).ok()).unwrap_or(0),
        inputs: operated.then(|| log.path().to_owned()),
        stand_by,
        unchecked: said(UNCHECKED).is_some(),
        // The directory of the files is temporary, so the log's own entry about the data is kept.
        remarks: said(DATA).map(|data| (DATA.to_owned(), data.to_owned())).into_iter().collect(),
        log: LogTarget::None,
        shared_memory: false,
        ..RunConfig::new(data, job.to_string_lossy())
    })
}

#[must_use]
pub fn fork_remarks(tick: u64, changes: &[String]) -> BTreeMap<String, String> {
    let entries = [(FORKED_AFTER, tick.to_string()), (CHANGES, changes.join("; "))];
    entries.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
}

/// Write a file of a log under a directory. Logs are untrusted: the name must not lead out of the directory.
fn write(under: &Path, name: &str, file: &Attachment) -> Result<PathBuf, RepeatError> {
    let inside = Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
    if !inside || name.is_empty() {
        return Err(RepeatError::Name(name.to_owned()));
    }
    let path = under.join(name);
    let failed = |source| RepeatError::Write { path: path.clone(), source };
    path.parent().map_or(Ok(()), fs::create_dir_all).map_err(failed)?;
    fs::write(&path, &file.data).map_err(failed)?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_name_in_a_log_stays_in_its_directory() {
        let file = Attachment::text("x", "text");
        for name in ["", "..", "../x", "/etc/x", "a/../../x"] {
            let refused = write(Path::new("/nowhere"), name, &file);
            assert!(matches!(refused, Err(RepeatError::Name(_))), "{name}: {refused:?}");
        }
    }

    #[test]
    fn silence_is_stored_with_the_robot_in_the_log() {
        for text in ["sim", "sim,silence=60"] {
            assert_eq!(text.parse::<RobotConfig>().map(|robot| robot.to_string()).as_deref(), Ok(text));
        }
    }
}
