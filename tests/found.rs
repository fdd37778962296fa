//! Other programs find live runs, also outside a service or a container.

use std::{
    path::Path,
    process::{Child, Command, Output, Stdio},
    thread,
    time::{Duration, Instant},
};

use rustix::process::{Pid, Signal, geteuid, kill_process};
use tempfile::{TempDir, tempdir};
use whole_system_tests::{rcs_run, root};

const TIME_LIMIT: Duration = Duration::from_secs(60); // of each action

struct Runs(TempDir); // for one test, outside the directories for temporary files

impl Runs {
    fn new() -> Self {
        Self(TempDir::new_in("/dev/shm").unwrap())
    }

    fn program(&self, program: &Path, arguments: &[&str]) -> Command {
        let mut command = Command::new(program);
        command.args(arguments).env("RCS_RUNS", self.0.path()).current_dir(root()).stdin(Stdio::null());
        command
    }

    fn rcs(&self, arguments: &[&str]) -> Command {
        self.program(rcs_run(), arguments)
    }

    fn status(&self, arguments: &[&str]) -> Output {
        self.rcs(&[&["status"], arguments].concat()).output().unwrap()
    }

    fn wait_for(&self, arguments: &[&str], text: &str) {
        let started = Instant::now();
        loop {
            let output = self.status(arguments);
            let said = text_of(&output.stdout) + &text_of(&output.stderr);
            if said.contains(text) {
                return;
            }
            assert!(started.elapsed() < TIME_LIMIT, "{text:?} was expected: {said}");
            thread::sleep(Duration::from_millis(50));
        }
    }
}

fn text_of(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

struct Running(Child); // it is stopped at the end of the test

impl Running {
    fn begin(mut command: Command) -> Self {
        Self(command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap())
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = kill_process(Pid::from_child(&self.0), Signal::TERM); // an ended run needs no signal
        let _ = self.0.wait();
    }
}

#[expect(clippy::print_stderr, reason = "a test that is left out says so")]
fn may_unshare(what: &[&str]) -> bool {
    let may = geteuid().is_root()
        && Command::new("unshare").args(what).arg("true").status().is_ok_and(|status| status.success());
    if !may {
        eprintln!("no right to make a namespace: not tried");
    }
    may
}

/// The same happens with `PrivateTmp=yes` of the shipped unit, or a cleaner of temporary directories.
#[test]
fn a_run_with_a_private_and_emptied_tmp_is_found() {
    if !may_unshare(&["--mount"]) {
        return;
    }
    let runs = Runs::new();
    let script = "mount -t tmpfs tmpfs /tmp && mount -t tmpfs tmpfs /var/tmp && exec \"$@\"";
    let mut command = runs.program(Path::new("unshare"), &["--mount", "sh", "-c", script, "sh"]);
    command.arg(rcs_run()).args(["linkbar", "--clock", "real", "--log", "none", "--run", "service"]);
    command.env_remove("RCS_RUNS"); // the usual directory
    let running = Running::begin(command);
    let usual = |arguments: &[&str]| {
        Command::new(rcs_run()).args(arguments).current_dir(root()).env_remove("RCS_RUNS").output().unwrap()
    };
    let started = Instant::now();
    while !text_of(&usual(&["status", "service"]).stdout).contains("service: tick") {
        assert!(started.elapsed() < TIME_LIMIT, "{}", text_of(&usual(&["status", "service"]).stderr));
        thread::sleep(Duration::from_millis(50));
    }
    let sent = usual(&["send", "--run", "service", "status"]);
    assert!(sent.status.success(), "{}", text_of(&sent.stderr));
    drop(running);
}

/// The first processes of two containers have the same number.
#[test]
fn runs_in_separate_pid_namespaces_have_different_names() {
    let apart = ["--pid", "--fork", "--mount-proc", "--kill-child=TERM"];
    if !may_unshare(&apart) {
        return;
    }
    let runs = Runs::new();
    let both: Vec<_> = (0..2)
        .map(|_| {
            let mut command = runs.program(Path::new("unshare"), &apart);
            // `unshare` passes no signal on: the runs end by themselves.
            let ticks = ["linkbar", "--clock", "real", "--log", "none", "--ticks", "400"];
            command.arg(rcs_run()).args(ticks);
            Running::begin(command)
        })
        .collect();
    runs.wait_for(&[], "there are several runs, name one: linkbar-1.");
    let said = text_of(&runs.status(&[]).stderr);
    let names: Vec<_> = said.trim().split_once("name one: ").unwrap().1.split(", ").collect();
    assert_eq!(names.len(), 2, "{names:?}");
    for name in names {
        runs.wait_for(&[name], &format!("{name}: tick "));
    }
    drop(both);
}

#[test]
fn name_in_use_is_refused_and_its_log_is_kept() {
    let (runs, place) = (Runs::new(), tempdir().unwrap());
    let log = place.path().join("run.mcap");
    let run = ["linkbar", "--clock", "real", "--run", "taken", "--log", log.to_str().unwrap()];
    let running = Running::begin(runs.rcs(&run));
    runs.wait_for(&["taken"], "taken: tick ");
    let second = runs.rcs(&run).output().unwrap();
    let said = text_of(&second.stderr);
    assert_eq!(second.status.code(), Some(2), "{said}");
    assert!(said.contains("the name taken is in use by a run of this user"), "{said}");
    assert!(said.contains("choose another name with --run"), "{said}");
    let logs = std::fs::read_dir(place.path()).unwrap().count();
    assert_eq!(logs, 1, "the refused run has touched the log");
    drop(running);
}

#[test]
fn status_describes_waiting_and_ending_runs() {
    let (runs, place) = (Runs::new(), tempdir().unwrap());
    let address = format!("unix:{}", place.path().join("socket").display());
    let waits = ["--clock", "real", "--log", "none", "--network", &address, "--outside", "workstation"];
    let running = Running::begin(runs.rcs(&[&waits[..], &["--wait", "60", "--run", "waits"]].concat()));
    runs.wait_for(&[], "waits waits for workstation");
    let said = text_of(&runs.status(&["waits", "--json"]).stdout);
    assert!(said.contains("\"phase\":\"waits for workstation"), "{said}");
    let sent = runs.rcs(&["send", "--run", "waits", "stop"]).output().unwrap();
    assert!(text_of(&sent.stderr).contains("usually from its first tick on"), "{}", text_of(&sent.stderr));
    drop(running);

    let boards = ["linkbar", "--boards", "manual", "--log", "none", "--run", "boards"];
    let running = Running::begin(runs.rcs(&boards));
    runs.wait_for(&[], "boards waits for its boards; missing: board 2, 4, 6, 8");
    drop(running);

    let run = ["linkbar", "--clock", "real", "--log", "none", "--run", "ends"];
    let running = Running::begin(runs.rcs(&run));
    runs.wait_for(&["ends"], "GO-THRU");
    thread::sleep(Duration::from_secs(5)); // until the robot has its full speed
    let signal = |signal| kill_process(Pid::from_child(&running.0), signal).unwrap();
    signal(Signal::TERM);
    // The ramp is short, so the run is stopped while its status is read.
    let started = Instant::now();
    loop {
        signal(Signal::STOP);
        let said = text_of(&runs.status(&["ends"]).stdout);
        signal(Signal::CONT);
        if said.contains("ends ends: the robot ramps to rest") {
            break;
        }
        assert!(started.elapsed() < TIME_LIMIT, "{said}");
        thread::sleep(Duration::from_millis(20));
    }
    drop(running);
    let gone = runs.status(&[]);
    assert!(
        text_of(&gone.stderr).contains("no run of this user is in progress"),
        "{}",
        text_of(&gone.stderr)
    );
}
