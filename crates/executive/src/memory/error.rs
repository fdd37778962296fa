use std::{fmt::Debug, io, path::PathBuf, time::Duration};

use diagnostics::alternatives;

use super::{
    name::{NameError, RunName},
    objects::other_users,
};

#[derive(Debug, thiserror::Error)]
pub enum SharedMemoryError {
    #[error(transparent)]
    BadName(#[from] NameError),
    #[error("there is no run{}: {}", .run.as_ref().map_or_else(String::new, |run| format!(" named {run}")), alive_in_words(.run.as_deref(), .alive))]
    NoSuchRun {
        run: Option<String>, // the requested name; `None` if any run was accepted
        alive: Vec<RunName>,
    },
    #[error(
        "{run} {phase}: it can be watched and operated while its buffers are in shared memory, usually from its \
         first tick on"
    )]
    Starting {
        run: RunName,
        phase: String, // its announced state, as a phrase
    },
    #[error(
        "the name {run} is in use by a run of this user, which {phase}: choose another name with --run, or end that run"
    )]
    NameInUse {
        run: RunName,
        phase: String, // what that run says about its state
    },
    #[error(
        "run {run:?} has layout {theirs}, this program has {ours}: they were built from different sources"
    )]
    OtherLayout {
        run: String,
        theirs: String,
        ours: String, // the layout version of this program
    },
    #[error("iceoryx2 could not be started in {place:?}: {what}")]
    Node {
        place: PathBuf,
        what: String, // the error of iceoryx2
    },
    #[error("the buffers of {service} could not be set up in shared memory: {what}")]
    Service {
        service: &'static str,
        what: String, // the error of iceoryx2
    },
    /// A directory, file or object of runs belongs to another user, or other users may write to it.
    #[error(
        "{path:?} must belong to this user only ({what}): remove it, or set RCS_RUNS to another directory"
    )]
    NotOurs {
        path: PathBuf,
        what: String, // its wrong type, owner or mode
    },
    #[error("/dev/shm has {free} bytes left, a run needs {needed}")]
    Full {
        free: u64,   // number of free bytes
        needed: u64, // number of bytes that a run needs
    },
    #[error("{what} took longer than {}: another program may be stopped in the middle of it", seconds(*.limit))]
    Late { what: String, limit: Duration },
    /// iceoryx2 has panicked because its objects are damaged.
    #[error(
        "the objects of iceoryx2 in /dev/shm are damaged, another program has written into them; the next run \
         removes them"
    )]
    Damaged,
    #[error("{path:?}: {source}")]
    Io {
        path: PathBuf,     // path of the file or directory
        source: io::Error, // the error of the operating system
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
