//! Reasons why a log cannot be written, read or replayed.

use std::{
    fs,
    path::{Path, PathBuf},
};

use diagnostics::nearest;
use os_io::files;

#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    #[error("the log {path} cannot be created: {source}")]
    Create { path: PathBuf, source: std::io::Error },
    #[error("the log {path} is being written by another run: name another file with --log")]
    InUse { path: PathBuf },
    #[error("the log {path} was removed during the run")]
    Removed { path: PathBuf },
    #[error("the log could not be started: {}", deepest(.0))]
    Begin(#[source] mcap::McapError),
    #[error("the log could not be written further: {}", deepest(.0))]
    Write(#[from] mcap::McapError),
    #[error("a cell of at most {allowed} {what} was expected, this one has {found}")]
    CellTooLarge {
        what: &'static str,
        allowed: usize, // by a [`crate::CellFrame`]
        found: usize,
    },
    #[error("the thread that writes the log failed")]
    Thread,
}

/// The deepest source of an error, usually that of the file system.
fn deepest(error: &dyn std::error::Error) -> String {
    match error.source() {
        Some(source) => deepest(source),
        None => error.to_string(),
    }
}

#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    #[error("{path}: {source}")]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("{path} is not an MCAP file: {source}")]
    NotMcap { path: PathBuf, source: mcap::McapError },
    #[error(
        "{path} is an MCAP file without the metadata {:?}: it was not written by this program",
        crate::names::RUN
    )]
    NotALog { path: PathBuf },
    #[error("{path} holds the logs of several runs: open the log of one run")]
    Merged { path: PathBuf },
    #[error("{path} is damaged at its head: without the metadata of the run nothing in it can be read")]
    HeadDamaged { path: PathBuf },
    #[error(
        "the log has layout {found}, this program {expected}: use the program that wrote it{}",
        by(.version)
    )]
    OtherLayout {
        expected: String,
        found: String,
        version: String, // version of the program that wrote it, if known
    },
    #[error("the record of tick {tick} does not fit the layout: the log is damaged")]
    Damaged { tick: u64 },
}

impl ReadError {
    /// `path` is the path of the log. For a missing file, the text also names the most similar log in the directory.
    #[must_use]
    pub fn of(&self, path: &Path) -> String {
        let (named, mut text) = (path.display().to_string(), self.to_string());
        if !text.starts_with(&named) {
            text = format!("{named}: {text}");
        }
        if fs::symlink_metadata(path).is_err() {
            let beside = path.parent().filter(|parent| !parent.as_os_str().is_empty());
            let name = |path: &Path| path.file_name().map(|name| name.to_string_lossy().into_owned());
            let entries = files::list(beside.unwrap_or(Path::new("."))).unwrap_or_default();
            let logs = entries.iter().filter(|entry| entry.extension().is_some_and(|end| end == "mcap"));
            let logs: Vec<String> = logs.filter_map(|entry| name(entry)).collect();
            let wanted = name(path).unwrap_or_default();
            if let Some(near) = nearest(&wanted, logs.iter().map(String::as_str)) {
                text += &format!("; the nearest log is {}", path.with_file_name(near).display());
            }
        }
        text
    }
}

fn by(version: &str) -> String {
    if version.is_empty() { String::new() } else { format!(" (version {version})") }
}

#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    #[error(transparent)]
    Read(#[from] ReadError),
    #[error("the log holds no tick there that a replay could start from")]
    Empty,
    #[error("the inputs of tick {tick} cannot be read: {source}")]
    Inputs { tick: u64, source: rcs_core::plain::DecodeError },
    #[error("tick {tick} uses generation {generation} of the task data, which is not in the log")]
    Generation { tick: u64, generation: u32 },
    #[error("the attached task data does not load:\n{0}")]
    TaskData(String),
}
