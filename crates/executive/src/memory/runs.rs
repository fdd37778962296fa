//! Entering, finding and removing runs.
//!
//! A run has a name, a directory, and a prefix in shared memory ([`super::place`]). It is alive while a program holds a
//! role in it ([`super::presence`]). Dead runs are removed by name, without opening their objects.

use std::{
    fs, io,
    ops::Deref,
    os::unix::ffi::OsStrExt as _,
    path::{self, PathBuf},
};

use iceoryx2::{
    config::Config,
    node::{Node, NodeBuilder},
    prelude::{FileName, LogLevel, Path, SemanticString, ipc, set_log_level},
    service::service_name::ServiceName,
};

use super::{
    error::SharedMemoryError,
    layout::Epoch,
    name::RunName,
    objects::objects,
    place::{files, have_nodes, have_salt, layout, lock, own_directory, own_objects, place, prefix, root},
    presence::{self, Presence},
};

/// Greatest number of readers of a run at a time: consoles, monitors, recorders.
pub(super) const MAX_READERS: usize = 16;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    pub name: RunName,
    pub layout: String,
    /// True if a living program uses it: the run itself, or a reader that has not left yet.
    pub alive: bool,
}

#[derive(Debug, Default)]
pub struct Cleaned {
    pub removed: Vec<RunName>,
    /// Runs that are alive and were not touched.
    pub alive: Vec<RunName>,
    pub failed: Vec<SharedMemoryError>,
}

/// A program's access to a run: a node of iceoryx2, and the role that shows others that the program is alive.
pub(crate) struct RunNode {
    node: Node<ipc::Service>,
    _presence: Presence,
}

impl Deref for RunNode {
    type Target = Node<ipc::Service>;

    fn deref(&self) -> &Self::Target {
        &self.node
    }
}

/// The remains of a run: its directory, and its objects in shared memory.
#[must_use]
pub fn traces(name: &RunName) -> Vec<PathBuf> {
    let (place, prefix) = (place(name, &layout()), prefix(name, &layout()));
    place.exists().then_some(place).into_iter().chain(objects(&prefix)).collect()
}

/// The configuration with which all files and objects of iceoryx2 belong to this run only.
pub(super) fn config(name: &RunName) -> Result<Config, SharedMemoryError> {
    let prefix = prefix(name, &layout());
    let place = files(&prefix);
    let failed = |error| SharedMemoryError::Node { place: place.clone(), what: format!("{error:?}") };
    let mut config = Config::default();
    config.global.prefix = FileName::new(prefix.as_bytes()).map_err(failed)?;
    config.global.set_root_path(&Path::new(place.as_os_str().as_bytes()).map_err(failed)?);
    Ok(config)
}

pub(crate) fn enter(name: &RunName, role: &str) -> Result<RunNode, SharedMemoryError> {
    // Suppress warnings of iceoryx2 on standard error: this program has its own messages for them.
    set_log_level(LogLevel::Fatal);
    let _lock = lock()?;
    have_salt()?;
    let (place, prefix, config) = (place(name, &layout()), prefix(name, &layout()), config(name)?);
    let directory = files(&prefix);
    let failed = |what: String| SharedMemoryError::Node { place: directory.clone(), what };
    let presence = Presence::enter(&prefix, role)?;
    own_directory(place)?;
    own_directory(directory.clone())?;
    have_nodes(&prefix)?;
    own_objects(&prefix)?;
    let role = role.try_into().map_err(|error| failed(format!("{error:?}")))?;
    let node = NodeBuilder::new()
        .name(&role)
        .config(&config)
        .create()
        .map_err(|error| failed(format!("{error:?}")))?;
    own_objects(&prefix)?;
    Ok(RunNode { node, _presence: presence })
}

/// True if a living program has a role in a run of this layout.
pub(crate) fn is_there(name: &RunName, role: &str) -> bool {
    presence::is_held(&prefix(name, &layout()), role)
}

pub(crate) fn service_name(service: &'static str, epoch: Epoch) -> Result<ServiceName, SharedMemoryError> {
    ServiceName::new(&format!("rcs-ii/{service}/{epoch}"))
        .map_err(|error| SharedMemoryError::service(service, &error))
}

/// All runs of this user with remains in shared memory, alive or not, by name.
pub fn list() -> Result<Vec<Found>, SharedMemoryError> {
    let root = root();
    if matches!(fs::symlink_metadata(&root), Err(error) if error.kind() == io::ErrorKind::NotFound) {
        return Ok(Vec::new());
    }
    let _lock = lock()?;
    let entries = fs::read_dir(&root).map_err(|source| SharedMemoryError::Io { path: root, source })?;
    let mut found = Vec::new();
    for entry in entries.flatten() {
        let file_name = entry.file_name();
        let Some((name, layout)) = file_name.to_str().and_then(|text| text.rsplit_once('@')) else {
            continue;
        };
        let Ok(name) = name.parse::<RunName>() else { continue };
        let alive = presence::is_alive(&prefix(&name, layout));
        found.push(Found { name, layout: layout.to_owned(), alive });
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(found)
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

pub(crate) fn has_living(name: &RunName, role: &str) -> bool {
    presence::is_held(&prefix(name, &layout()), role)
}

/// Remove the remains of killed runs. Failed removals are in the result.
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

/// Remove the objects of killed runs without a directory here; returns the number of these runs.
pub fn clean_objects() -> Result<usize, SharedMemoryError> {
    let dead: Vec<String> =
        presence::prefixes().into_iter().filter(|prefix| !presence::is_alive(prefix)).collect();
    dead.iter().try_for_each(|prefix| remove_objects(prefix))?;
    Ok(dead.len())
}

/// Remove a run's directory and objects if no living program uses it; returns false if one does.
pub(crate) fn remove_if_deserted(name: &RunName, layout: &str) -> Result<bool, SharedMemoryError> {
    let _lock = lock()?;
    remove_remains(name, layout)
}

/// The same, for a caller that holds the lock.
pub(super) fn remove_remains(name: &RunName, layout: &str) -> Result<bool, SharedMemoryError> {
    let (place, prefix) = (place(name, layout), prefix(name, layout));
    if presence::is_alive(&prefix) {
        return Ok(false);
    }
    remove_objects(&prefix)?;
    match remove(&place) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(SharedMemoryError::Io { path: place, source })
        }
        _ => Ok(true),
    }
}

/// Remove a directory with all its contents, or a file.
fn remove(path: &path::Path) -> io::Result<()> {
    let is_directory = fs::symlink_metadata(path).is_ok_and(|found| found.is_dir());
    if is_directory { fs::remove_dir_all(path) } else { fs::remove_file(path) }
}

fn remove_objects(prefix: &str) -> Result<(), SharedMemoryError> {
    for path in objects(prefix) {
        match remove(&path) {
            Err(source) if source.kind() != io::ErrorKind::NotFound => {
                return Err(SharedMemoryError::Io { path, source });
            }
            _ => {}
        }
    }
    Ok(())
}
