//! Limits of a log: a run of months writes logs one after the other, and keeps the newest.
//!
//! Each log begins with whole images and states, so it can be read and replayed without the others.

use std::{
    fs, io,
    path::{Path, PathBuf},
    time::SystemTime,
};

use crate::file::is_earlier;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LogLimit {
    /// Size, bytes, after which the run begins a new log. A log exceeds this size by its end and by one second.
    pub bytes: u64,
    /// Greatest number of kept earlier logs with the name of this one; the oldest are removed. `None` keeps all.
    pub kept: Option<usize>,
}

impl LogLimit {
    /// True if `path` is an earlier log of `log`. The oldest of them may be removed.
    #[must_use]
    pub fn may_remove(&self, log: &Path, path: &Path) -> bool {
        let directory = |path: &Path| {
            let directory = path.parent().filter(|directory| !directory.as_os_str().is_empty());
            fs::canonicalize(directory.unwrap_or(Path::new("."))).ok()
        };
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        self.kept.is_some() && is_earlier(log, &path) && directory(log) == directory(&path)
    }

    pub(crate) fn remove_oldest(&self, log: &Path) -> io::Result<()> {
        let Some(kept) = self.kept else { return Ok(()) };
        let directory = log.parent().filter(|directory| !directory.as_os_str().is_empty());
        let mut earlier: Vec<(SystemTime, PathBuf)> = Vec::new();
        for entry in fs::read_dir(directory.unwrap_or(Path::new(".")))? {
            let path = entry?.path();
            if is_earlier(log, &path) {
                earlier.push((fs::symlink_metadata(&path)?.modified()?, path));
            }
        }
        earlier.sort();
        let surplus = earlier.len().saturating_sub(kept);
        earlier.iter().take(surplus).try_for_each(|(_, path)| fs::remove_file(path))
    }
}
