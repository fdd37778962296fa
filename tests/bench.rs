//! Runs of the survival tests and the robustness campaign, observed from outside, and their remains.

use std::{
    os::unix::process::ExitStatusExt as _,
    path::{Path, PathBuf},
    process::{Child, Command, Output, Stdio},
    thread,
    time::{Duration, Instant},
};

use executive::memory::{self, Attached, RunName};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;

use crate::{rcs_run, root};

/// Time limit for actions that take milliseconds.
const PATIENCE: Duration = Duration::from_secs(120);

#[must_use]
pub fn rcs(directory: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(rcs_run());
    command.args(arguments).current_dir(directory).stdin(Stdio::null());
    command
}

#[must_use]
pub fn job(name: &str) -> Vec<String> {
    let data = root().join("data").display().to_string();
    ["run", name, "--json", "--data", data.as_str()].map(str::to_owned).to_vec()
}

pub struct Running {
    /// The controller, or board 0.
    pub child: Child,
    pub name: RunName,
}

impl Running {
    /// Start a run with further arguments.
    ///
    /// # Panics
    /// If the program cannot be started.
    #[must_use]
    pub fn start(directory: &Path, name: &str, more: &[&str]) -> Self {
        let arguments = job(name);
        let all: Vec<&str> = arguments.iter().map(String::as_str).chain(more.iter().copied()).collect();
        let child = rcs(directory, &all)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("rcs-run can be started");
        let name = format!("{name}-{}", child.id()).parse().expect("the name of a run");
        Self { child, name }
    }

    /// Attach a reader as soon as there are buffers to read.
    ///
    /// # Panics
    /// If the run ends before.
    pub fn attach(&mut self) -> Attached {
        let mut reader = None;
        wait_for("the run shows its buffers", || {
            assert!(self.child.try_wait().expect("a child").is_none(), "{} ended at once", self.name);
            reader = Attached::open(&self.name).ok();
            reader.is_some()
        });
        reader.expect("it was there")
    }

    /// Wait until a tick has been run. Returns the last tick.
    ///
    /// # Panics
    /// If the run ends before.
    pub fn reach(&mut self, reader: &Attached, tick: u64) -> u64 {
        let mut reached = 0;
        wait_for("the run gets on", || {
            if let Ok(pulse) = reader.pulse() {
                assert!(!pulse.over, "{} was over before it reached tick {tick}", self.name);
                reached = pulse.tick.0;
            }
            reached >= tick
        });
        reached
    }

    /// Send a signal to its process.
    ///
    /// # Panics
    /// If the process has ended.
    pub fn signal(&self, signal: Signal) {
        let pid = Pid::from_child(&self.child);
        kill_process(pid, signal).expect("the run can be sent a signal");
    }

    /// End it by SIGKILL.
    ///
    /// # Panics
    /// If the signal cannot be sent.
    pub fn kill(&mut self) {
        self.child.kill().expect("it can be killed");
        self.child.wait().expect("it is dead");
    }

    /// Wait for its end.
    ///
    /// # Panics
    /// If that is impossible.
    #[must_use]
    pub fn end(self) -> Ended {
        Ended::of(&self.child.wait_with_output().expect("it ends"))
    }
}

pub struct Ended {
    /// `None` if a signal ended it.
    pub status: Option<i32>,
    pub signal: Option<i32>,
    pub result: Value,
    pub said: String,
}

impl Ended {
    #[must_use]
    pub fn of(output: &Output) -> Self {
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let result = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
        Self { status: output.status.code(), signal: output.status.signal(), result, said }
    }

    /// Run to the end with further arguments.
    ///
    /// # Panics
    /// If the program cannot be started.
    #[must_use]
    pub fn run(directory: &Path, name: &str, more: &[&str]) -> Self {
        Running::start(directory, name, more).end()
    }

    /// The digest of all output buffers of all ticks.
    ///
    /// # Panics
    /// If there is none.
    #[must_use]
    pub fn digest(&self) -> &str {
        self.result["digest"].as_str().unwrap_or_else(|| panic!("no digest: {}", self.said))
    }

    /// A number of the result.
    ///
    /// # Panics
    /// If there is none of this name.
    #[must_use]
    pub fn number(&self, field: &str) -> u64 {
        self.result[field].as_u64().unwrap_or_else(|| panic!("no {field} in {}", self.result))
    }

    /// Assert that it finished and that its buffers were in shared memory.
    ///
    /// # Panics
    /// Otherwise.
    pub fn assert_shared(&self) {
        assert_eq!(self.status, Some(0), "{}", self.said);
        for complaint in ["shared memory is not available", "not mirrored"] {
            assert!(!self.said.contains(complaint), "{}", self.said);
        }
    }

    #[must_use]
    pub fn last_words(&self) -> &str {
        self.said.lines().last().unwrap_or_default()
    }
}

/// Run the linkbar in its own mount namespace, after some shell commands. `None` if this user cannot make namespaces.
#[must_use]
pub fn apart(directory: &Path, shell: &str, more: &[&str]) -> Option<Ended> {
    let arguments = job("linkbar");
    let output = Command::new("unshare")
        .args(["--mount", "sh", "-c", &format!("{shell}; exec \"$@\""), "sh"])
        .arg(rcs_run())
        .args(arguments.iter().map(String::as_str).chain(more.iter().copied()))
        .current_dir(directory)
        .output();
    let ended = Ended::of(&output.ok()?);
    let refused = ["unshare: ", "mount: "].iter().any(|tool| ended.said.contains(tool));
    (!refused).then_some(ended)
}

/// Files and objects in shared memory of a run.
#[must_use]
pub fn traces(run: &RunName) -> Vec<PathBuf> {
    memory::traces(run)
}

/// Assert that `rcs-run clean` leaves nothing of the run.
///
/// # Panics
/// Otherwise.
pub fn assert_cleaned(directory: &Path, run: &RunName) {
    let cleaned = rcs(directory, &["clean"]).output().expect("rcs-run can be started");
    assert_eq!(cleaned.status.code(), Some(0), "{}", String::from_utf8_lossy(&cleaned.stderr));
    assert_eq!(traces(run), Vec::<PathBuf>::new());
}

/// Wait for a condition that will soon hold.
///
/// # Panics
/// If it does not hold in time.
pub fn wait_for(what: &str, mut condition: impl FnMut() -> bool) {
    let started = Instant::now();
    while !condition() {
        assert!(started.elapsed() < PATIENCE, "not in time: {what}");
        thread::sleep(Duration::from_millis(1));
    }
}
