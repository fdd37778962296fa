//! Where runs live in shared memory, and how they are found and removed.
//!
//! Every run has a name and a directory of its own, `<temporary directory>/rcs-ii-<user>/<name>@<layout>`, in
//! which iceoryx2 keeps its files, and its own prefix of names in shared memory. So parallel runs and tests
//! never meet, users do not disturb each other, and what a killed run left behind is found by looking, and
//! removed when nobody who is alive uses it.

use std::{
    fmt::{self, Debug},
    fs::{self, File},
    io,
    os::unix::fs::{DirBuilderExt, MetadataExt, PermissionsExt},
    path::PathBuf,
    str::FromStr,
    time::Duration,
};

use iceoryx2::{
    config::Config,
    node::{Node, NodeBuilder, NodeState, NodeView as _},
    prelude::{CallbackProgression, FileName, LogLevel, Path, SemanticString, ipc, set_log_level},
    service::service_name::ServiceName,
};
use rcs_core::digest::Digest;
use rustix::{
    fs::{FallocateFlags, fallocate, statvfs},
    process::geteuid,
};

use super::buffers::{Epoch, layout_version};

/// Readers of a run at a time: consoles, monitors, recorders.
pub(super) const MAX_READERS: usize = 16;
/// Where Linux keeps shared memory objects.
const SHARED_MEMORY: &str = "/dev/shm";
/// Bytes of shared memory that must be free before a run makes its objects: more than twice what they take.
const NEEDED: u64 = 2 * 1024 * 1024;
/// How long a clean-up waits for another program that is cleaning up the same run.
const PATIENCE: Duration = Duration::from_secs(2);

/// Why common memory is not shared.
#[derive(Debug, thiserror::Error)]
pub enum SharedMemoryError {
    /// A name that no run can have.
    #[error(
        "a run's name has 1 to {RUN_NAME_MAX} letters, digits, dots, hyphens or underscores, {0:?} is not one"
    )]
    BadName(String),
    /// A path that iceoryx2 does not take.
    #[error("{0:?} cannot be used for shared memory: the path is too long or has unusual characters")]
    BadPath(PathBuf),
    /// No living run of that name, or none at all.
    #[error("there is no run{}: {}", .run.as_ref().map_or_else(String::new, |run| format!(" named {run}")), alive_in_words(.alive))]
    NoSuchRun {
        /// As asked for; `None` if any would do.
        run: Option<String>,
        /// The runs that live.
        alive: Vec<RunName>,
    },
    /// A run whose program has another layout of buffers.
    #[error(
        "run {run:?} has layout {theirs}, this program has {ours}: they were built from different sources"
    )]
    OtherLayout {
        /// Name of the run.
        run: String,
        /// Its layout version.
        theirs: String,
        /// The layout version of this program.
        ours: String,
    },
    /// The node could not be created.
    #[error("iceoryx2 could not be started in {place:?}: {what}")]
    Node {
        /// Directory of the run.
        place: PathBuf,
        /// What iceoryx2 says.
        what: String,
    },
    /// A service could not be created or opened.
    #[error("the buffers of {service} could not be set up in shared memory: {what}")]
    Service {
        /// Name of the service.
        service: &'static str,
        /// What iceoryx2 says.
        what: String,
    },
    /// The directory of runs belongs to somebody else, or others may write in it.
    #[error("{path:?} is not this user's alone ({what}): remove it, or set TMPDIR to another directory")]
    NotOurs {
        /// The directory.
        path: PathBuf,
        /// What it is instead.
        what: String,
    },
    /// There is too little shared memory.
    #[error("{SHARED_MEMORY} has {free} bytes left, a run needs {needed}")]
    Full {
        /// Bytes that are free.
        free: u64,
        /// Bytes that a run needs.
        needed: u64,
    },
    /// A file could not be removed or a directory not be read.
    #[error("{path:?}: {source}")]
    Io {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}

impl SharedMemoryError {
    pub(crate) fn service(service: &'static str, what: &dyn Debug) -> Self {
        Self::Service { service, what: format!("{what:?}") }
    }
}

fn alive_in_words(alive: &[RunName]) -> String {
    match alive {
        [] => "no run shows its buffers at the moment".to_owned(),
        some => format!("there is {}", some.iter().map(RunName::as_str).collect::<Vec<_>>().join(", ")),
    }
}

/// Most characters of a run's name. The path of an event's socket holds it, and Linux gives such a path 107 bytes.
pub const RUN_NAME_MAX: usize = 28;
/// Bytes of a path that a socket can have.
const SOCKET_PATH: usize = 107;
/// Most bytes that iceoryx2 puts between a prefix and the end of a socket's path: a number of 31 digits and `.event`.
const SOCKET_NAME: usize = 37;

/// Name of a run: letters, digits, dots, hyphens and underscores.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RunName(String);

impl RunName {
    /// A name that no other living run of this machine has: the job and the number of this operating system
    /// process. Characters of the job that a name cannot have become hyphens.
    #[must_use]
    pub fn unique(job: &str) -> Self {
        let suffix = format!("-{}", std::process::id());
        let room = RUN_NAME_MAX - suffix.len();
        let job: String =
            job.chars().take(room).map(|c| if is_name_character(c) { c } else { '-' }).collect();
        Self(job + &suffix)
    }

    /// The name as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

fn is_name_character(c: char) -> bool {
    c.is_ascii_alphanumeric() || "-_.".contains(c)
}

impl FromStr for RunName {
    type Err = SharedMemoryError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let good = (1..=RUN_NAME_MAX).contains(&text.len())
            && text.chars().all(is_name_character)
            && text.starts_with(|c: char| c.is_ascii_alphanumeric());
        if good { Ok(Self(text.to_owned())) } else { Err(SharedMemoryError::BadName(text.to_owned())) }
    }
}

impl fmt::Display for RunName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}

/// A run as found in shared memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// Its name.
    pub name: RunName,
    /// Layout version of the program that runs it.
    pub layout: String,
    /// Somebody alive uses it: the run itself, or a reader that has not left yet.
    pub alive: bool,
}

/// What [`clean`] did.
#[derive(Debug, Default)]
pub struct Cleaned {
    /// Runs that were removed.
    pub removed: Vec<RunName>,
    /// Runs that live and were left alone.
    pub alive: Vec<RunName>,
    /// What could not be removed.
    pub failed: Vec<SharedMemoryError>,
}

/// Directory of all runs of this user.
#[must_use]
pub fn root() -> PathBuf {
    std::env::temp_dir().join(format!("rcs-ii-{}", geteuid().as_raw()))
}

/// The layout version of this program as it stands in names.
#[must_use]
pub fn layout() -> String {
    format!("{:08x}", layout_version())
}

/// Directory of a run of this layout.
pub(super) fn directory(name: &RunName) -> PathBuf {
    place(name, &layout())
}

fn place(name: &RunName, layout: &str) -> PathBuf {
    root().join(format!("{name}@{layout}"))
}

/// What the names of a run's objects in shared memory start with: short, since it stands in paths of sockets too.
#[must_use]
pub fn prefix(name: &RunName, layout: &str) -> String {
    let mut digest = Digest::new();
    digest.add(&geteuid().as_raw().to_le_bytes());
    digest.add(layout.as_bytes());
    digest.add(name.as_str().as_bytes());
    let value = digest.value();
    format!("rcs-{:08x}_", (value ^ (value >> 32)) & u64::from(u32::MAX))
}

/// What lies around of a run: its directory, and its objects in shared memory.
#[must_use]
pub fn traces(name: &RunName) -> Vec<PathBuf> {
    let (place, prefix) = (place(name, &layout()), prefix(name, &layout()));
    place.exists().then_some(place).into_iter().chain(objects(&prefix)).collect()
}

/// Held while a run's directory is made or removed, so that nobody clears away what another program is just
/// setting up. The system releases it when its holder ends, however that happens.
fn lock() -> Result<File, SharedMemoryError> {
    let root = root();
    let path = root.join("lock");
    let failed = |source| SharedMemoryError::Io { path: path.clone(), source };
    own_root()?;
    let file = File::options().create(true).append(true).open(&path).map_err(failed)?;
    file.lock().map_err(failed)?;
    Ok(file)
}

/// The directory of runs is there, and this user's alone.
pub(super) fn own_root() -> Result<(), SharedMemoryError> {
    own_directory(&root())
}

/// Makes the directory of runs, or sees that it is what an earlier run made. Its place can be guessed and lies
/// where everybody may write, so somebody else may have been there first.
fn own_directory(path: &std::path::Path) -> Result<(), SharedMemoryError> {
    let failed = |source| SharedMemoryError::Io { path: path.to_owned(), source };
    match fs::DirBuilder::new().mode(0o700).create(path) {
        Ok(()) => return Ok(()),
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
        Err(source) => return Err(failed(source)),
    }
    let found = fs::symlink_metadata(path).map_err(failed)?;
    let what = if !found.is_dir() {
        "it is no directory".to_owned()
    } else if found.uid() != geteuid().as_raw() {
        format!("it belongs to user {}", found.uid())
    } else if found.mode() & 0o022 != 0 {
        format!("others may write in it, mode {:o}", found.mode() & 0o777)
    } else if found.mode() & 0o077 != 0 {
        // Made by hand, or by an earlier version.
        return fs::set_permissions(path, fs::Permissions::from_mode(0o700)).map_err(failed);
    } else {
        return Ok(());
    };
    Err(SharedMemoryError::NotOurs { path: path.to_owned(), what })
}

/// See that events of a run can have their sockets.
pub(crate) fn have_sockets(name: &RunName) -> Result<(), SharedMemoryError> {
    let (place, prefix) = (place(name, &layout()), prefix(name, &layout()));
    let longest = place.as_os_str().len() + 1 + prefix.len() + SOCKET_NAME;
    if longest > SOCKET_PATH { Err(SharedMemoryError::BadPath(place)) } else { Ok(()) }
}

/// See that there is shared memory for a run. A page that the system cannot lay under an object when it is
/// first touched ends the program with a bus error, so one has to ask beforehand.
pub(crate) fn have_room() -> Result<(), SharedMemoryError> {
    let Ok(found) = statvfs(SHARED_MEMORY) else { return Ok(()) };
    let free = found.f_bavail.saturating_mul(found.f_frsize);
    if free < NEEDED { Err(SharedMemoryError::Full { free, needed: NEEDED }) } else { Ok(()) }
}

/// Have the system lay pages under all objects of a run, so that none is missing when it is first touched.
pub(crate) fn reserve(name: &RunName) -> Result<(), SharedMemoryError> {
    let prefix = prefix(name, &layout());
    for path in objects(&prefix) {
        let failed = |source| SharedMemoryError::Io { path: path.clone(), source };
        let file = match File::options().read(true).write(true).open(&path) {
            // Of a board that has left meanwhile.
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

/// The configuration under which all of a run's files and objects are its own.
pub(super) fn config(name: &RunName, layout: &str) -> Result<Config, SharedMemoryError> {
    let place = place(name, layout);
    let bad = || SharedMemoryError::BadPath(place.clone());
    let mut config = Config::default();
    config.global.prefix = FileName::new(prefix(name, layout).as_bytes()).map_err(|_| bad())?;
    let path = place.to_str().ok_or_else(bad)?;
    config.global.set_root_path(&Path::new(path.as_bytes()).map_err(|_| bad())?);
    Ok(config)
}

/// A node of iceoryx2 in a run of this layout.
pub(crate) fn node(name: &RunName, role: &str) -> Result<Node<ipc::Service>, SharedMemoryError> {
    // iceoryx2 warns on standard error where this program has its own words for the same.
    set_log_level(LogLevel::Fatal);
    let config = config(name, &layout())?;
    let place = place(name, &layout());
    let failed = |what: String| SharedMemoryError::Node { place: place.clone(), what };
    let _lock = lock()?;
    fs::create_dir_all(&place).map_err(|source| SharedMemoryError::Io { path: place.clone(), source })?;
    let role = role.try_into().map_err(|error| failed(format!("{error:?}")))?;
    let node = NodeBuilder::new()
        .name(&role)
        .config(&config)
        .create()
        .map_err(|error| failed(format!("{error:?}")))?;
    keep_to_owner(&prefix(name, &layout()))?;
    Ok(node)
}

/// Take the objects of a run from everybody but their owner: iceoryx2 makes that of a node for all to write.
fn keep_to_owner(prefix: &str) -> Result<(), SharedMemoryError> {
    for path in objects(prefix) {
        match fs::set_permissions(&path, fs::Permissions::from_mode(0o600)) {
            Ok(()) => {}
            // A reader that has just left takes its object with it.
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(source) => return Err(SharedMemoryError::Io { path, source }),
        }
    }
    Ok(())
}

pub(crate) fn service_name(service: &'static str, epoch: Epoch) -> Result<ServiceName, SharedMemoryError> {
    ServiceName::new(&format!("rcs-ii/{service}/{epoch}"))
        .map_err(|error| SharedMemoryError::service(service, &error))
}

/// All runs of this user that left something in shared memory, alive or not, in the order of their names.
///
/// # Errors
/// [`SharedMemoryError::Io`] if the directory of runs cannot be read.
pub fn list() -> Result<Vec<Found>, SharedMemoryError> {
    set_log_level(LogLevel::Fatal);
    let root = root();
    let entries = match fs::read_dir(&root) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(source) => return Err(SharedMemoryError::Io { path: root, source }),
    };
    let mut found = Vec::new();
    for entry in entries.flatten() {
        let file_name = entry.file_name();
        let Some((name, layout)) = file_name.to_str().and_then(|text| text.rsplit_once('@')) else {
            continue;
        };
        let Ok(name) = name.parse::<RunName>() else { continue };
        let alive = config(&name, layout).is_ok_and(|config| is_alive(&entry.path(), &config));
        found.push(Found { name, layout: layout.to_owned(), alive });
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(found)
}

/// A place of a run is a directory; what has only the name of one is nobody's.
fn is_directory(place: &std::path::Path) -> bool {
    fs::symlink_metadata(place).is_ok_and(|found| found.is_dir())
}

/// True if a node of a program that is alive, or that may be, is in the run.
fn is_alive(place: &std::path::Path, config: &Config) -> bool {
    if !is_directory(place) {
        return false;
    }
    let mut alive = false;
    let listed = Node::<ipc::Service>::list(config, |node| {
        alive |= !matches!(node, NodeState::Dead(_));
        CallbackProgression::Continue
    });
    alive || listed.is_err()
}

/// Find a living run that this program can read, by its name.
pub(crate) fn find_living(name: &RunName) -> Result<(), SharedMemoryError> {
    let ours = layout();
    let runs = list()?;
    let mut named = runs.iter().filter(|run| run.name == *name && run.alive);
    match named.clone().find(|run| run.layout == ours).or_else(|| named.next()) {
        None => {
            let alive = runs.iter().filter(|run| run.alive).map(|run| run.name.clone()).collect();
            Err(SharedMemoryError::NoSuchRun { run: Some(name.to_string()), alive })
        }
        Some(run) if run.layout != ours => {
            Err(SharedMemoryError::OtherLayout { run: name.to_string(), theirs: run.layout.clone(), ours })
        }
        Some(_) => Ok(()),
    }
}

/// True if a node that lives, or may live, has the role in a run.
pub(crate) fn has_living(name: &RunName, role: &str) -> bool {
    let Ok(config) = config(name, &layout()) else { return false };
    let mut found = false;
    let listed = Node::<ipc::Service>::list(&config, |node| {
        found |= match node {
            NodeState::Alive(view) => {
                view.details().as_ref().is_none_or(|details| details.name().as_str() == role)
            }
            NodeState::Dead(_) => false,
            NodeState::Inaccessible(_) | NodeState::Undefined(_) => true,
        };
        if found { CallbackProgression::Stop } else { CallbackProgression::Continue }
    });
    found || listed.is_err()
}

/// Remove what killed runs left in shared memory; living runs are left alone.
///
/// # Errors
/// [`SharedMemoryError::Io`] if the directory of runs cannot be read. What could not be removed is in the
/// answer.
pub fn clean() -> Result<Cleaned, SharedMemoryError> {
    let mut cleaned = Cleaned::default();
    for run in list()? {
        match remove_if_deserted(&run.name, &run.layout) {
            Ok(true) => cleaned.removed.push(run.name),
            Ok(false) => cleaned.alive.push(run.name),
            Err(error) => cleaned.failed.push(error),
        }
    }
    Ok(cleaned)
}

/// The last one out: removes a run's directory and objects if no living node is left in it; false if there is
/// one.
pub(crate) fn remove_if_deserted(name: &RunName, layout: &str) -> Result<bool, SharedMemoryError> {
    let config = config(name, layout)?;
    let place = place(name, layout);
    let _lock = lock()?;
    if is_alive(&place, &config) {
        return Ok(false);
    }
    let mut dead = Vec::new();
    let _ = Node::<ipc::Service>::list(&config, |node| {
        if let NodeState::Dead(view) = node {
            dead.push(view);
        }
        CallbackProgression::Continue
    });
    for view in dead {
        // Whatever iceoryx2 cannot remove in an orderly way goes with the directory and the prefix below.
        let _ = view.blocking_remove_stale_resources(PATIENCE);
    }
    remove_objects(&prefix(name, layout))?;
    let removed = if is_directory(&place) { fs::remove_dir_all(&place) } else { fs::remove_file(&place) };
    match removed {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(SharedMemoryError::Io { path: place, source })
        }
        _ => Ok(true),
    }
}

/// The objects in shared memory whose names start with a run's prefix.
fn objects(prefix: &str) -> impl Iterator<Item = PathBuf> {
    let entries = fs::read_dir(SHARED_MEMORY).into_iter().flatten().flatten();
    entries
        .filter(move |entry| entry.file_name().to_str().is_some_and(|name| name.starts_with(prefix)))
        .map(|entry| entry.path())
}

/// Removes the objects of a run. iceoryx2 itself leaves one of 16 bytes behind even after an orderly end.
fn remove_objects(prefix: &str) -> Result<(), SharedMemoryError> {
    for path in objects(prefix) {
        match fs::remove_file(&path) {
            Err(source) if source.kind() != io::ErrorKind::NotFound => {
                return Err(SharedMemoryError::Io { path, source });
            }
            _ => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_checked() {
        assert!("linkbar-17".parse::<RunName>().is_ok());
        for bad in ["", "a/b", "..", "-x", "ab cd", &"x".repeat(RUN_NAME_MAX + 1)] {
            assert!(matches!(bad.parse::<RunName>(), Err(SharedMemoryError::BadName(_))), "{bad:?}");
        }
        let long = RunName::unique(&"job with blanks ".repeat(5));
        assert!(long.as_str().len() <= RUN_NAME_MAX && long.as_str().parse::<RunName>().is_ok(), "{long}");
    }
}
