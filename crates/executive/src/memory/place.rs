//! Paths of a run, and the checks that only this user can access them.
//!
//! The directory of runs is in shared memory: a directory for temporary files is cleaned while a run lives, and a
//! service has its own. `RCS_RUNS` names another directory, for tests; the files of iceoryx2 are never in it, because
//! paths of sockets have at most 107 bytes. The prefix of a run's objects is a hash of a random number in the directory
//! of runs. So runs in different directories never collide, and another user cannot take a name first.

use std::{
    fs::{self, DirBuilder, File, Metadata, OpenOptions, Permissions, TryLockError},
    io::{self, Write as _},
    os::unix::fs::{DirBuilderExt as _, MetadataExt as _, OpenOptionsExt as _, PermissionsExt as _},
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant},
};

use rcs_core::digest::Digest;
use rustix::{
    fs::{FallocateFlags, fallocate, statvfs},
    process::geteuid,
};

use super::{
    error::SharedMemoryError,
    layout::layout_version,
    name::RunName,
    objects::{ROOT, SHARED_MEMORY, objects},
};

/// Bytes of shared memory that must be free before a run creates its objects, which take 1.9 MB with boards.
const NEEDED: u64 = 3 * 1024 * 1024;
const FILES: &str = "files"; // suffix of the prefix in the name of the directory of iceoryx2
/// Longest wait for a lock, which other programs hold for milliseconds.
pub(super) const LOCK_LIMIT: Duration = Duration::from_secs(5);
const AGAIN: Duration = Duration::from_millis(1); // time between two attempts to take a lock
const OTHERS: u32 = 0o077; // permission bits of other users

const ELSEWHERE: &str = "RCS_RUNS";
#[must_use]
pub fn root() -> PathBuf {
    let named = std::env::var_os(ELSEWHERE).filter(|named| !named.is_empty());
    let parent = named.map_or_else(|| PathBuf::from(SHARED_MEMORY), PathBuf::from);
    parent.join(format!("{ROOT}{}", geteuid().as_raw()))
}

#[must_use]
pub fn layout() -> String {
    format!("{:08x}", layout_version())
}

pub(super) fn place(name: &RunName, layout: &str) -> PathBuf {
    root().join(format!("{name}@{layout}"))
}

pub(super) fn files(prefix: &str) -> PathBuf {
    Path::new(SHARED_MEMORY).join(format!("{prefix}{FILES}"))
}

/// The socket through which operators reach a run, in a directory that only this user can access.
#[must_use]
pub fn operator_socket(name: &RunName) -> PathBuf {
    files(&prefix(name, &layout())).join("operator")
}

/// The file of a load for boards: the generation and the name of the blocks in the first line, then the blocks.
#[must_use]
pub fn load_file(name: &RunName, load: u32) -> PathBuf {
    files(&prefix(name, &layout())).join(format!("load-{load}"))
}

/// Prefix of the names of a run's objects in shared memory: short, because paths of sockets contain it.
#[must_use]
pub fn prefix(name: &RunName, layout: &str) -> String {
    let mut digest = Digest::new();
    // Without a directory of runs there are no objects.
    digest.add(&fs::read(root().join("salt")).unwrap_or_default());
    digest.add(layout.as_bytes());
    digest.add(name.as_str().as_bytes());
    let value = digest.value();
    format!("rcs-{:08x}_", (value ^ (value >> 32)) & u64::from(u32::MAX))
}

/// Take the lock for listing runs, and for creating or removing a run's directory.
pub(super) fn lock() -> Result<File, SharedMemoryError> {
    own_root()?;
    let path = root().join("lock");
    let file = own_file(&path)?;
    let deadline = Instant::now() + LOCK_LIMIT;
    loop {
        match file.try_lock() {
            Ok(()) => return Ok(file),
            Err(TryLockError::WouldBlock) if Instant::now() < deadline => thread::sleep(AGAIN),
            Err(TryLockError::WouldBlock) => {
                return Err(SharedMemoryError::Late {
                    what: format!("the lock {path:?}"),
                    limit: LOCK_LIMIT,
                });
            }
            Err(TryLockError::Error(source)) => return Err(SharedMemoryError::Io { path, source }),
        }
    }
}

/// Open a file that only this user can access, for a lock, and create it if it does not exist.
pub(super) fn own_file(path: &Path) -> Result<File, SharedMemoryError> {
    let failed = |source| SharedMemoryError::Io { path: path.to_owned(), source };
    let mut options = OpenOptions::new();
    options
        .create(true)
        .append(true)
        .mode(0o600)
        .custom_flags(rustix::fs::OFlags::NOFOLLOW.bits().cast_signed());
    let file = options.open(path).map_err(failed)?;
    ours(path, &file.metadata().map_err(failed)?)?;
    Ok(file)
}

/// Make sure that the random number of this directory of runs exists. The caller must hold the lock.
pub(super) fn have_salt() -> Result<(), SharedMemoryError> {
    let path = root().join("salt");
    let mut file = own_file(&path)?;
    let failed = |source| SharedMemoryError::Io { path: path.clone(), source };
    if file.metadata().map_err(failed)?.len() == 0 {
        let number = getrandom::u64().map_err(|error| failed(io::Error::other(error.to_string())))?;
        file.write_all(format!("{number:016x}").as_bytes()).map_err(failed)?;
    }
    Ok(())
}

fn own_root() -> Result<(), SharedMemoryError> {
    own_directory(root())
}

pub(super) fn own_directory(path: PathBuf) -> Result<(), SharedMemoryError> {
    let failed = |source| SharedMemoryError::Io { path: path.clone(), source };
    match DirBuilder::new().mode(0o700).create(&path) {
        Ok(()) => return Ok(()),
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
        Err(source) => return Err(failed(source)),
    }
    // The path is predictable and its parent is writable for all users: another user may have created it.
    let found = fs::symlink_metadata(&path).map_err(failed)?;
    let owned = found.uid() == geteuid().as_raw();
    if found.is_dir() && owned && found.mode() & 0o022 == 0 && found.mode() & OTHERS != 0 {
        // The user has created it by hand.
        return fs::set_permissions(&path, Permissions::from_mode(0o700)).map_err(failed);
    }
    match found.is_dir() {
        true => alone(&path, &found),
        false => Err(SharedMemoryError::NotOurs { path, what: "it is not a directory".to_owned() }),
    }
}

/// Check that the path is a regular file that only this user can access.
fn ours(path: &Path, found: &Metadata) -> Result<(), SharedMemoryError> {
    match found.is_file() {
        true => alone(path, found),
        false => Err(SharedMemoryError::NotOurs {
            path: path.to_owned(),
            what: "it is not a regular file".to_owned(),
        }),
    }
}

fn alone(path: &Path, found: &Metadata) -> Result<(), SharedMemoryError> {
    let what = if found.uid() != geteuid().as_raw() {
        format!("it belongs to user {}", found.uid())
    } else if found.mode() & OTHERS != 0 {
        format!("other users may use it, mode {:o}", found.mode() & 0o777)
    } else {
        return Ok(());
    };
    Err(SharedMemoryError::NotOurs { path: path.to_owned(), what })
}

/// Check that all objects of a run are regular files that only this user can access, except the directory of iceoryx2.
pub(super) fn own_objects(prefix: &str) -> Result<(), SharedMemoryError> {
    let directory = files(prefix);
    for path in objects(prefix) {
        match fs::symlink_metadata(&path) {
            Ok(found) if path == directory && found.is_dir() => alone(&path, &found)?,
            Ok(found) => ours(&path, &found)?,
            // A reader that has just left removes its object.
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(source) => return Err(SharedMemoryError::Io { path, source }),
        }
    }
    Ok(())
}

/// The object that iceoryx2 0.10.0 keeps for all nodes of a run: name after the prefix, and first bytes (version,
/// counter).
const NODES: (&str, [u8; 16]) = (
    "9204dd183d1c4d8e1ff592a30766ffa6765aa8b5_node.0_10_0.global_mgmt",
    [0, 0, 10, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
);

/// Create the object for all nodes of a run, if it does not exist. iceoryx2 would make it writable for all users.
pub(super) fn have_nodes(prefix: &str) -> Result<(), SharedMemoryError> {
    let path = Path::new(SHARED_MEMORY).join(format!("{prefix}{}", NODES.0));
    let failed = |source| SharedMemoryError::Io { path: path.clone(), source };
    match OpenOptions::new().write(true).create_new(true).mode(0o600).open(&path) {
        Ok(mut file) => file.write_all(&NODES.1).map_err(failed),
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Ok(()),
        Err(source) => Err(failed(source)),
    }
}

/// Check that there is enough shared memory: a page that is missing at its first access ends the program.
pub(crate) fn have_room() -> Result<(), SharedMemoryError> {
    let Ok(found) = statvfs(SHARED_MEMORY) else { return Ok(()) };
    let free = found.f_bavail.saturating_mul(found.f_frsize);
    if free < NEEDED { Err(SharedMemoryError::Full { free, needed: NEEDED }) } else { Ok(()) }
}

/// Allocate the pages of all objects of a run, so that none is missing at the first access.
pub(crate) fn reserve(name: &RunName) -> Result<(), SharedMemoryError> {
    let prefix = prefix(name, &layout());
    let directory = files(&prefix);
    for path in objects(&prefix).filter(|path| *path != directory) {
        let failed = |source| SharedMemoryError::Io { path: path.clone(), source };
        let file = match File::options().read(true).write(true).open(&path) {
            // It belonged to a board that has left in the meantime.
            Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
            other => other.map_err(failed)?,
        };
        let length = file.metadata().map_err(failed)?.len();
        if length > 0 {
            fallocate(&file, FallocateFlags::empty(), 0, length).map_err(|error| failed(error.into()))?;
        }
    }
    Ok(())
}
