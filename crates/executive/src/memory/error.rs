//! Errors of shared memory, with messages for the user.

use std::{fmt::Debug, io, path::PathBuf, time::Duration};

use diagnostics::alternatives;

use super::{
    name::{NameError, RunName},
    objects::other_users,
};

#[derive(Debug, thiserror::Error)]
pub enum SharedMemoryError {
    /// A name that is not valid for a run.
    #[error(transparent)]
    BadName(#[from] NameError),
    /// There is no living run of that name, or no living run at all.
    #[error("there is no run{}: {}", .run.as_ref().map_or_else(String::new, |run| format!(" named {run}")), alive_in_words(.run.as_deref(), .alive))]
    NoSuchRun {
        /// The requested name; `None` if any run was accepted.
        run: Option<String>,
        alive: Vec<RunName>,
    },
    /// A run that has not published its buffers yet.
    #[error(
        "{run} {phase}: it can be watched and operated while its buffers are in shared memory, usually from its \
         first tick on"
    )]
    Starting {
        run: RunName,
        /// Its announced state, as a phrase.
        phase: String,
    },
    /// A living run has the name.
    #[error(
        "the name {run} is in use by a run of this user, which {phase}: choose another name with --run, or end that run"
    )]
    NameInUse {
        run: RunName,
        /// What that run says about its state.
        phase: String,
    },
    /// A run whose program has another layout of buffers.
    #[error(
        "run {run:?} has layout {theirs}, this program has {ours}: they were built from different sources"
    )]
    OtherLayout {
        run: String,
        theirs: String,
        /// The layout version of this program.
        ours: String,
    },
    /// The node could not be created.
    #[error("iceoryx2 could not be started in {place:?}: {what}")]
    Node {
        place: PathBuf,
        /// The error of iceoryx2.
        what: String,
    },
    /// A service could not be created or opened.
    #[error("the buffers of {service} could not be set up in shared memory: {what}")]
    Service {
        service: &'static str,
        /// The error of iceoryx2.
        what: String,
    },
    /// A directory, file or object of runs belongs to another user, or other users may write to it.
    #[error(
        "{path:?} must belong to this user only ({what}): remove it, or set RCS_RUNS to another directory"
    )]
    NotOurs {
        path: PathBuf,
        /// Its wrong type, owner or mode.
        what: String,
    },
    /// There is too little shared memory.
    #[error("/dev/shm has {free} bytes left, a run needs {needed}")]
    Full {
        /// Number of free bytes.
        free: u64,
        /// Number of bytes that a run needs.
        needed: u64,
    },
    /// An operation of another program took too long.
    #[error("{what} took longer than {}: another program may be stopped in the middle of it", seconds(*.limit))]
    Late { what: String, limit: Duration },
    /// iceoryx2 has panicked because its objects are damaged.
    #[error(
        "the objects of iceoryx2 in /dev/shm are damaged, another program has written into them; the next run \
         removes them"
    )]
    Damaged,
    /// A file could not be removed or a directory could not be read.
    #[error("{path:?}: {source}")]
    Io {
        /// Path of the file or directory.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
}

impl SharedMemoryError {
    pub(crate) fn service(service: &'static str, what: &dyn Debug) -> Self {
        Self::Service { service, what: format!("{what:?}") }
    }
}

fn seconds(limit: Duration) -> String {
    format!("{} s", limit.as_secs())
}

fn alive_in_words(wanted: Option<&str>, alive: &[RunName]) -> String {
    match alive {
        [] => match &other_users()[..] {
            [] => "no run of this user is in progress".to_owned(),
            [first, ..] => format!(
                "no run of this user is in progress; user {first} has run some, try: sudo -u '#{first}' rcs-run status"
            ),
        },
        some => alternatives(wanted.unwrap_or_default(), some.iter().map(RunName::as_str), "there is"),
    }
}
