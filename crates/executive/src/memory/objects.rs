//! The objects in shared memory: files of all users in one directory.

use std::{fs, path::PathBuf};

use rustix::process::geteuid;

pub(super) const SHARED_MEMORY: &str = "/dev/shm";
/// Name of the directory of runs, before the number of the user.
pub(super) const ROOT: &str = "rcs-runs-";

/// The objects in shared memory whose names start with a run's prefix.
pub(super) fn objects(prefix: &str) -> impl Iterator<Item = PathBuf> {
    let entries = fs::read_dir(SHARED_MEMORY).into_iter().flatten().flatten();
    entries
        .filter(move |entry| entry.file_name().to_str().is_some_and(|name| name.starts_with(prefix)))
        .map(|entry| entry.path())
}

/// Numbers of the other users of this machine that have a directory of runs.
pub(super) fn other_users() -> Vec<u32> {
    let own = geteuid().as_raw();
    let user = |path: PathBuf| path.file_name()?.to_str()?.strip_prefix(ROOT)?.parse().ok();
    let mut users: Vec<u32> = objects(ROOT).filter_map(user).filter(|user| *user != own).collect();
    users.sort_unstable();
    users
}
