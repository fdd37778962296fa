//! Runs of the survival tests and the robustness campaign, observed from outside.

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

const TIME_LIMIT: Duration = Duration::from_secs(120); // for actions that take milliseconds

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
    pub child: Child, // or board 0
    pub name: RunName,
}

impl Running {
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

    pub fn attach(&mut self) -> Attached {
        let mut reader = None;
        wait_for("the run shows its buffers", || {
            assert!(self.child.try_wait().expect("a child").is_none(), "{} ended at once", self.name);
            reader = Attached::open(&self.name).ok();
            reader.is_some()
        });
        reader.expect("it was there")
    }

    /// Waits until a tick has been run. Returns the last tick.
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

    pub fn kill(&mut self) {
        self.child.kill().expect("it can be killed");
        self.child.wait().expect("it is dead");
    }

    #[must_use]
    pub fn end(self) -> Ended {
        Ended::of(&self.child.wait_with_output().expect("it ends"))
    }
}

pub struct Ended {
    pub status: Option<i32>, // `None` after a signal
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

    #[must_use]
    pub fn run(directory: &Path, name: &str, more: &[&str]) -> Self {
        Running::start(directory, name, more).end()
    }

    #[must_use]
    pub fn digest(&self) -> &str {
        self.result["digest"].as_str().unwrap_or_else(|| panic!("no digest: {}", self.said))
    }

    #[must_use]
    pub fn number(&self, field: &str) -> u64 {
        self.result[field].as_u64().unwrap_or_else(|| panic!("no {field} in {}", self.result))
    }

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

/// A run in its own mount namespace. `None` if this user cannot make namespaces.
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

#[must_use]
pub fn traces(run: &RunName) -> Vec<PathBuf> {
    memory::traces(run)
}

pub fn assert_cleaned(directory: &Path, run: &RunName) {
    let cleaned = rcs(directory, &["clean"]).output().expect("rcs-run can be started");
    assert_eq!(cleaned.status.code(), Some(0), "{}", String::from_utf8_lossy(&cleaned.stderr));
    assert_eq!(traces(run), Vec::<PathBuf>::new());
}

pub fn wait_for(what: &str, mut condition: impl FnMut() -> bool) {
    let started = Instant::now();
    while !condition() {
        assert!(started.elapsed() < TIME_LIMIT, "not in time: {what}");
        thread::sleep(Duration::from_millis(1));
    }
}
