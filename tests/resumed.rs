//! `kill -9` of `rcs-run` while its robot and its devices live on in `rcs-cell`, and the resume of the run
//! (docs/resume.md). `RCS_KILLS` is the number of kills per connection (default 1), at different moments.

use std::{
    fs,
    io::{BufRead as _, BufReader, Write as _},
    net::{TcpListener, UdpSocket},
    path::Path,
    process::{Child, ChildStdin, Command, Output, Stdio},
    sync::mpsc,
    thread,
    time::{Duration, Instant},
};

use executive::memory::{Attached, RunName};
use serde_json::Value;
use whole_system_tests::{Scratch, rcs_cell, rcs_run, root};

const TIME_LIMIT: Duration = Duration::from_secs(120); // of each wait
/// Slow enough that a robot stays near its path on a busy machine.
const MOVES: &str = "** joystick velocity 300\n\
                     == MOVE -- +0 -- 0 +0 SAFE 0 -- 0\n\
                     == MOVE -- +0 -- 0 +0 HOME 0 -- 0\n";
const TICKS: [u64; 2] = [60, 260]; // first and last moment of a kill: the robot moves to SAFE
/// The vise closes, a person fills a tray, and the vise opens.
const LINES: &str = "== MOVE -- +0 -- 0 +0 HOME 0 -- 0\n\
                     ** vise close PFIXTURE\n\
                     ** tray UNIT_1 4 LINKBAR1_BH\n\
                     ** vise open PFIXTURE\n\
                     == MOVE -- +0 -- 0 +0 HOME 0 -- 0\n";

fn kills() -> u32 {
    std::env::var("RCS_KILLS").map_or(1, |text| text.parse().expect("RCS_KILLS is a number"))
}

/// A moment of kill number `kill`: the steps follow the golden ratio.
fn moment(kill: u32) -> u64 {
    let phase = (f64::from(kill) * 0.618_033_988_75 + 0.3).fract();
    TICKS[0] + (phase * (TICKS[1] - TICKS[0]) as f64) as u64
}

/// `rcs-cell` with what lives on. It ends with the test.
struct Cell {
    child: Child,
    console: ChildStdin,
    screen: mpsc::Receiver<String>,
}

impl Cell {
    fn start(arguments: &[&str]) -> Self {
        let mut child = Command::new(rcs_cell())
            .current_dir(root())
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("rcs-cell can be started");
        let (lines, screen) = mpsc::channel();
        let output = BufReader::new(child.stdout.take().expect("piped"));
        thread::spawn(move || output.lines().map_while(Result::ok).try_for_each(|line| lines.send(line)));
        Self { console: child.stdin.take().expect("piped"), child, screen }
    }

    fn wait_for(&self, text: &str) {
        let mut lines = std::iter::from_fn(|| self.screen.recv_timeout(TIME_LIMIT).ok());
        assert!(lines.any(|line| line.contains(text)), "{text:?} was not printed");
    }

    fn enter(&mut self, line: &str) {
        writeln!(self.console, "{line}").expect("the cell reads lines");
    }
}

impl Drop for Cell {
    fn drop(&mut self) {
        self.child.kill().expect("it can be ended");
        self.child.wait().expect("it has ended");
    }
}

struct Controller {
    child: Child,
    name: RunName,
}

impl Controller {
    fn start(scratch: &Scratch, job: &str, more: &[&str]) -> Self {
        let path = scratch.file("short.job");
        fs::write(&path, job).expect("a job");
        let name = RunName::unique("resumed");
        let clock = if more.contains(&"--clock") { &[][..] } else { &["--clock", "real"] };
        let child = Command::new(rcs_run())
            .current_dir(root())
            .args(["--json", "--log", "none", "--run", name.as_str()])
            .args(clock)
            .args(more)
            .arg(&path)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("rcs-run can be started");
        Self { child, name }
    }

    fn wait(&mut self, what: &str, mut condition: impl FnMut(&RunName) -> bool) {
        let started = Instant::now();
        while !condition(&self.name) {
            let has_ended = self.child.try_wait().expect("a child").is_some();
            assert!(!has_ended, "the run has ended before {what}");
            assert!(started.elapsed() < TIME_LIMIT, "not in time: {what}");
            thread::sleep(Duration::from_millis(20));
        }
    }

    fn kill_at(mut self, tick: u64) {
        let reached = |name: &RunName| {
            let pulse = Attached::open(name).ok().and_then(|reader| reader.pulse().ok());
            pulse.is_some_and(|pulse| pulse.tick.0 >= tick)
        };
        self.wait("the tick of the kill", reached);
        self.kill();
    }

    fn kill(mut self) {
        self.child.kill().expect("it can be killed");
        self.child.wait().expect("it is dead");
    }

    fn send(name: &RunName, line: &str) -> Output {
        let send = Command::new(rcs_run()).args(["send", "--run", name.as_str(), line]).output();
        send.expect("rcs-run can be started")
    }

    /// Continues the job as a person does, once the run answers. Returns what the controller knew.
    fn go(&mut self) -> String {
        let mut known = String::new();
        self.wait("an answer to `resume`", |name| {
            let answer = Self::send(name, "resume");
            known = String::from_utf8_lossy(&answer.stdout).into_owned();
            // The robot's program must run, and its position be known, before a person sends `job go`.
            answer.status.success() && !known.contains("give no position")
        });
        self.wait("the job continues", |name| {
            let answer = Self::send(name, "job go");
            // An answer may be too late for the sender of a busy machine; then the job plays already.
            answer.status.success() || String::from_utf8_lossy(&answer.stderr).contains("plays already")
        });
        known
    }

    fn end(self) -> (Option<i32>, Value, String) {
        let output = self.child.wait_with_output().expect("it ends");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), serde_json::from_slice(&output.stdout).unwrap_or_default(), said)
    }
}

fn assert_resumed(scratch: &Scratch, job: &str, more: &[&str], kill: u32) {
    let journal = scratch.file("run.journal").display().to_string();
    let mut run = Controller::start(scratch, job, &[more, &["--resume", &journal]].concat());
    let known = run.go();
    let (status, result, said) = run.end();
    let tick = moment(kill);
    assert_eq!(status, Some(0), "killed at {tick}: {known}{}: {said}", result["failure"]["text"]);
    assert!(said.contains("the run is resumed"), "{said}");
}

#[test]
#[ignore = "in real time, for a machine without other load"]
fn killed_run_with_a_robot_at_a_port_is_resumed() {
    for kill in 0..kills() {
        let scratch = Scratch::new("resumed-depc");
        let link = scratch.file("t3").display().to_string();
        let cell = Cell::start(&["--link", &link, "--auto"]);
        cell.wait_for("WD1");
        let robot = format!("serial:{link}");
        let journal = scratch.file("run.journal").display().to_string();
        let run = Controller::start(&scratch, MOVES, &["--robot", &robot, "--journal", &journal]);
        run.kill_at(moment(kill));
        assert_resumed(&scratch, MOVES, &["--robot", &robot], kill);
    }
}

#[test]
#[ignore = "in real time, for a machine without other load"]
fn killed_run_with_an_egm_robot_is_resumed() {
    for kill in 0..kills() {
        let scratch = Scratch::new("resumed-egm");
        let free =
            UdpSocket::bind("127.0.0.1:0").and_then(|socket| socket.local_addr()).expect("a free port");
        let robot = format!("egm:{}", free.port());
        let mut cell = Cell::start(&["--emulate", &robot]);
        let journal = scratch.file("run.journal").display().to_string();
        let run = Controller::start(&scratch, MOVES, &["--robot", &robot, "--journal", &journal]);
        run.kill_at(moment(kill));
        // The robot's program has ended, as after a loss of the network; a person starts it again.
        cell.wait_for("CommTimeout");
        cell.enter("start");
        assert_resumed(&scratch, MOVES, &["--robot", &robot], kill);
    }
}

/// Robot, vise and tray are real for the run: the station of the cell lives on, and its watchdogs fire.
#[test]
#[ignore = "in real time, for a machine without other load"]
fn killed_run_with_devices_behind_couplers_is_resumed() {
    let scratch = Scratch::new("resumed-station");
    let (mapping, network) = free_station(&scratch);
    let free = UdpSocket::bind("127.0.0.1:0").and_then(|socket| socket.local_addr()).expect("a free port");
    let port = free.port().to_string();
    let mut cell = Cell::start(&["--egm-robot", &port, "--vision", &network, "--station", &mapping]);
    cell.wait_for("[station] ready");
    let robot = format!("egm:{port}");
    let journal = scratch.file("run.journal").display().to_string();
    let more = ["--outside", "vision", "--network", &network, "--robot", &robot, "--field", &mapping];
    let mut run = Controller::start(&scratch, LINES, &[&more[..], &["--journal", &journal]].concat());
    run.wait("the line of the tray", |_| {
        let journal = record::journal::open(Path::new(&journal));
        journal.is_ok_and(|contents| contents.newest.line == 3 && contents.newest.begun)
    });
    run.kill();
    cell.wait_for("CommTimeout");
    for line in ["start", "tray UNIT_1 4 LINKBAR1_BH"] {
        cell.enter(line);
    }
    let mut run = Controller::start(&scratch, LINES, &[&more[..], &["--resume", &journal]].concat());
    run.go();
    let (status, result, said) = run.end();
    assert_eq!(status, Some(0), "{}: {said}", result["failure"]["text"]);
    assert!(said.contains("that are off") && said.contains("vise.PFIXTURE.close"), "{said}");
}

/// The shipped mapping with free addresses, and an address for the neighbours.
fn free_station(scratch: &Scratch) -> (String, String) {
    let mut text = fs::read_to_string(root().join("data/field/station.toml")).expect("the mapping");
    let free = [21502, 21503, 21504].map(|_| TcpListener::bind("127.0.0.1:0").expect("a free port"));
    for (shipped, free) in [21502, 21503, 21504].into_iter().zip(&free) {
        let address = free.local_addr().expect("an address").to_string();
        text = text.replace(&format!("127.0.0.1:{shipped}"), &address);
    }
    let mapping = scratch.file("free.toml");
    fs::write(&mapping, text).expect("a mapping");
    (mapping.display().to_string(), format!("unix:{}", scratch.file("rcs.sock").display()))
}

/// One process of four is killed, so the run ends; the whole run is resumed from the journal of board 0.
#[test]
#[ignore = "in real time, for a machine without other load"]
fn split_run_that_has_lost_a_board_is_resumed() {
    let scratch = Scratch::new("resumed-split");
    let journal = scratch.file("run.journal").display().to_string();
    let split = ["--boards", "split"];
    let mut run = Controller::start(&scratch, MOVES, &[&split[..], &["--journal", &journal]].concat());
    let reader = |name: &RunName| Attached::open(name).ok().and_then(|reader| reader.pulse().ok());
    run.wait("a motion", |name| reader(name).is_some_and(|pulse| pulse.tick.0 >= TICKS[0] + 30));
    let board = board_of(&run.child);
    rustix::process::kill_process(board, rustix::process::Signal::KILL).expect("a board can be killed");
    let (status, _, said) = run.end();
    assert_eq!(status, Some(3), "{said}");
    assert_resumed(&scratch, MOVES, &split, 0);
}

/// The process of a board of a run.
fn board_of(run: &Child) -> rustix::process::Pid {
    let children = format!("/proc/{0}/task/{0}/children", run.id());
    let children = fs::read_to_string(children).expect("the system lists children");
    let first = children.split_whitespace().next().and_then(|pid| pid.parse().ok());
    rustix::process::Pid::from_raw(first.expect("a board")).expect("a process")
}

/// STARTUP connects the Data System, which learns that the robot has the blank.
const ITEM: &str = "== STARTUP -- +0 -- 0 +0 -- 0 -- 0\n\
                    ** tray UNIT_1 4 LINKBAR1_BH\n\
                    ** vise partial PFIXTURE LINKBAR\n\
                    == MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0 #17\n";

#[test]
fn killed_run_keeps_its_session_with_the_data_system() {
    for in_file in [true, false] {
        let scratch = Scratch::new("resumed-items");
        let (items, journal) = (scratch.file("items.db"), scratch.file("run.journal").display().to_string());
        let items = items.display().to_string();
        let file = if in_file { vec!["--database", &items] } else { Vec::new() };
        let more = [&["--clock", "20x"], &file[..]].concat();
        let run = Controller::start(&scratch, ITEM, &[&more[..], &["--journal", &journal]].concat());
        run.kill_at(400);
        let mut run = Controller::start(&scratch, ITEM, &[&more[..], &["--resume", &journal]].concat());
        run.go();
        let (status, result, said) = run.end();
        assert_eq!(status, Some(0), "{}: {said}", result["failure"]["text"]);
        assert_eq!(result["data_base"][0]["serial"], "17", "{said}");
        assert_eq!(said.contains("so they are lost"), !in_file, "{said}");
    }
}
