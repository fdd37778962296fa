//! Detects which programs use a run: each role has a lock on a file next to the run's objects. The system releases it
//! when the program ends, for any reason. Remains of a killed run need not be opened.

use std::{
    fs::{self, File, TryLockError},
    io,
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant},
};

use rustix::process::geteuid;

use super::{
    error::SharedMemoryError,
    objects::{SHARED_MEMORY, objects},
    place::{LOCK_LIMIT, own_file},
};

const MARK: &str = "alive."; // text after the prefix in the name of a lock file; the role comes last
/// Another program that tests whether the role is held keeps the lock for less than this.
const ASKING: Duration = Duration::from_millis(2);
/// Number of times a held lock is tested, to distinguish a holder from a program that tests.
const LOOKS: usize = 3;

/// Holds a role in a run until it is dropped. Several readers share one role.
pub(super) struct Presence {
    _lock: File,
}

impl Presence {
    /// Take a role in the run with this prefix.
    pub(super) fn enter(prefix: &str, role: &str) -> Result<Self, SharedMemoryError> {
        let path = path(prefix, role);
        let failed = |source| SharedMemoryError::Io { path: path.clone(), source };
        let deadline = Instant::now() + LOCK_LIMIT;
        while Instant::now() < deadline {
            let file = own_file(&path)?;
            match file.try_lock_shared() {
                // A program that removed the dead run may have removed the file in the meantime.
                Ok(()) if is_at(&file, &path).map_err(failed)? => return Ok(Self { _lock: file }),
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => thread::sleep(ASKING),
                Err(TryLockError::Error(source)) => return Err(failed(source)),
            }
        }
        Err(SharedMemoryError::Late { what: format!("the lock {path:?}"), limit: LOCK_LIMIT })
    }
}

fn path(prefix: &str, role: &str) -> PathBuf {
    Path::new(SHARED_MEMORY).join(format!("{prefix}{MARK}{role}"))
}

fn is_at(file: &File, path: &Path) -> io::Result<bool> {
    match fs::symlink_metadata(path) {
        Ok(found) => Ok(found.ino() == file.metadata()?.ino()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}

pub(super) fn is_held(prefix: &str, role: &str) -> bool {
    locked(&path(prefix, role))
}

pub(super) fn is_alive(prefix: &str) -> bool {
    objects(&format!("{prefix}{MARK}")).any(|path| locked(&path))
}

/// Prefixes of all runs of this user that have a lock file in shared memory, whichever directory of runs they use.
pub(super) fn prefixes() -> Vec<String> {
    let own =
        |path: &PathBuf| fs::symlink_metadata(path).is_ok_and(|found| found.uid() == geteuid().as_raw());
    let name = |path: PathBuf| path.file_name()?.to_str().map(str::to_owned);
    let mut found: Vec<String> = objects("rcs-")
        .filter(own)
        .filter_map(name)
        .filter_map(|name| name.split_once(MARK).map(|(prefix, _)| prefix.to_owned()))
        .collect();
    found.sort();
    found.dedup();
    found
}

fn locked(path: &Path) -> bool {
    let Ok(metadata) = fs::symlink_metadata(path) else { return false };
    // Only a regular file is a lock; opening another kind of file could block forever.
    let Some(file) = metadata.is_file().then(|| File::open(path).ok()).flatten() else { return false };
    for _ in 0..LOOKS {
        match file.try_lock() {
            Ok(()) => return false,
            Err(_) => thread::sleep(ASKING),
        }
    }
    true
}
