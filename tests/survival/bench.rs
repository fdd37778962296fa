//! What the survival tests have in common: runs that are watched from outside, and a look at what they leave.

use std::{
    path::{Path, PathBuf},
    process::{Child, Command, Output, Stdio},
    sync::Mutex,
    thread,
    time::{Duration, Instant},
};

use executive::memory::{self, Attached, RunName};
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;
use whole_system_tests::{rcs_run, root};

/// Runs of these tests one after the other: several in real time would disturb each other.
pub static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// How long something may take that takes milliseconds.
const PATIENCE: Duration = Duration::from_secs(120);

/// `rcs-run` with arguments, in a directory.
pub fn rcs(directory: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(rcs_run());
    command.args(arguments).current_dir(directory).stdin(Stdio::null());
    command
}

/// The arguments of a run of a job of the data directory.
pub fn job(name: &str) -> Vec<String> {
    let data = root().join("data").display().to_string();
    ["run", name, "--json", "--data", data.as_str()].map(str::to_owned).to_vec()
}

/// A run that goes on.
pub struct Running {
    pub child: Child,
    pub name: RunName,
}

impl Running {
    /// Start a run, with more arguments.
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

    /// A reader, as soon as there is something to read.
    pub fn attach(&mut self) -> Attached {
        let mut reader = None;
        wait_for("the run shows its buffers", || {
            assert!(self.child.try_wait().expect("a child").is_none(), "{} ended at once", self.name);
            reader = Attached::open(&self.name).ok();
            reader.is_some()
        });
        reader.expect("it was there")
    }

    /// Wait until a tick was run; the tick that was run by then.
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

    pub fn signal(&self, signal: Signal) {
        let pid = Pid::from_child(&self.child);
        kill_process(pid, signal).expect("the run can be sent a signal");
    }

    /// Kill it as nobody can prevent.
    pub fn kill(&mut self) {
        self.child.kill().expect("it can be killed");
        self.child.wait().expect("it is dead");
    }

    /// Wait for its end.
    pub fn end(self) -> Ended {
        Ended::of(&self.child.wait_with_output().expect("it ends"))
    }
}

/// A run that is over.
pub struct Ended {
    pub status: Option<i32>,
    pub result: Value,
    /// What stood on standard error.
    pub said: String,
}

impl Ended {
    pub fn of(output: &Output) -> Self {
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let result = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
        Self { status: output.status.code(), result, said }
    }

    /// Run to the end, with more arguments.
    pub fn run(directory: &Path, name: &str, more: &[&str]) -> Self {
        Running::start(directory, name, more).end()
    }

    pub fn digest(&self) -> &str {
        self.result["digest"].as_str().unwrap_or_else(|| panic!("no digest: {}", self.said))
    }

    pub fn number(&self, field: &str) -> u64 {
        self.result[field].as_u64().unwrap_or_else(|| panic!("no {field} in {}", self.result))
    }

    /// It ended well, and everybody could look on.
    pub fn assert_shared(&self) {
        assert_eq!(self.status, Some(0), "{}", self.said);
        for complaint in ["cannot be had", "not mirrored"] {
            assert!(!self.said.contains(complaint), "{}", self.said);
        }
    }

    pub fn last_words(&self) -> &str {
        self.said.lines().last().unwrap_or_default()
    }
}

/// Files and objects in shared memory of a run.
pub fn traces(run: &RunName) -> Vec<PathBuf> {
    memory::traces(run)
}

/// Nothing is left after `rcs-run clean`.
pub fn assert_cleaned(directory: &Path, run: &RunName) {
    let cleaned = rcs(directory, &["clean"]).output().expect("rcs-run can be started");
    assert_eq!(cleaned.status.code(), Some(0), "{}", String::from_utf8_lossy(&cleaned.stderr));
    assert_eq!(traces(run), Vec::<PathBuf>::new());
}

/// Wait for something that comes soon.
pub fn wait_for(what: &str, mut condition: impl FnMut() -> bool) {
    let started = Instant::now();
    while !condition() {
        assert!(started.elapsed() < PATIENCE, "in vain waited for: {what}");
        thread::sleep(Duration::from_millis(1));
    }
}
