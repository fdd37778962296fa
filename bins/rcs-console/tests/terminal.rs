//! The program in a pseudo-terminal, whose output a terminal parser reads.

use std::{
    fs::File,
    io::{Read, Write},
    num::NonZero,
    os::{fd::OwnedFd, unix::net::UnixStream},
    path::{Path, PathBuf},
    process::{Child, Command},
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

mod recording;

use runtime::{Boards, ClockKind, LogTarget, Observer, Run, RunConfig};
use rustix::{
    fs::{Mode, OFlags, open},
    process::{Pid, Signal, kill_process},
    pty,
    termios::{Action, Termios, Winsize, tcflow, tcgetattr, tcsetwinsize},
};

const LINES: NonZero<u16> = NonZero::new(24).unwrap();
const COLUMNS: NonZero<u16> = NonZero::new(80).unwrap();
const TO_SAFE: &str = "== MOVE -- 0 -- 0 0 SAFE 0 -- 0\n";
const TIME_LIMIT: Duration = Duration::from_secs(60); // of each action, for a busy machine

struct Silent;

impl Observer for Silent {
    fn message(&mut self, _: &str) {}
}

/// Both ends of a new terminal. Programs started by the test do not inherit it.
fn open_terminal() -> (OwnedFd, OwnedFd) {
    let flags = pty::OpenptFlags::RDWR | pty::OpenptFlags::NOCTTY | pty::OpenptFlags::CLOEXEC;
    let master = pty::openpt(flags).unwrap();
    pty::unlockpt(&master).unwrap();
    let name = pty::ptsname(&master, Vec::new()).unwrap();
    let slave = open(&*name, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty()).unwrap();
    let size = Winsize { ws_row: LINES.get(), ws_col: COLUMNS.get(), ws_xpixel: 0, ws_ypixel: 0 };
    tcsetwinsize(&slave, size).unwrap();
    (master, slave)
}

fn begin_console(
    arguments: &[&str],
    directory: &Path,
    environment: &[(&str, &Path)],
    slave: &OwnedFd,
) -> Child {
    let end = || slave.try_clone().unwrap();
    Command::new(env!("CARGO_BIN_EXE_rcs-console"))
        .args(arguments)
        .current_dir(directory)
        .env("LC_ALL", "C.UTF-8")
        .envs(environment.iter().copied())
        .stdin(end())
        .stdout(end())
        .stderr(end())
        .spawn()
        .unwrap()
}

type Written = Vec<(Duration, Vec<u8>)>;

struct Terminal {
    child: Child,
    keys: File,
    slave: OwnedFd,
    parser: Arc<Mutex<vt100::Parser>>,
    written: Arc<Mutex<Written>>, // all output to the terminal, with times
    before: Termios,
}

impl Terminal {
    fn start(arguments: &[&str], directory: &Path, environment: &[(&str, &Path)]) -> Self {
        let (master, slave) = open_terminal();
        let before = tcgetattr(&slave).unwrap();
        let child = begin_console(arguments, directory, environment, &slave);
        let parser = Arc::new(Mutex::new(vt100::Parser::new(LINES, COLUMNS, 0)));
        let mut screen = File::from(master.try_clone().unwrap());
        let written = Arc::<Mutex<Written>>::default();
        let (shown, kept, begun) = (Arc::clone(&parser), Arc::clone(&written), Instant::now());
        thread::spawn(move || {
            let mut bytes = [0; 4096];
            while let Ok(count @ 1..) = screen.read(&mut bytes) {
                locked(&shown).process(&bytes[..count]);
                locked(&kept).push((begun.elapsed(), bytes[..count].to_vec()));
            }
        });
        Self { child, keys: File::from(master), slave, parser, written, before }
    }

    fn written(&self) -> Written {
        locked(&self.written).clone()
    }

    fn screen(&self) -> String {
        locked(&self.parser).screen().contents()
    }

    fn wait_for(&self, text: &str) {
        self.wait_while(|screen| !screen.contains(text), &format!("{text:?} did not appear"));
    }

    /// Press Escape, and wait until its text disappears. A terminal reads Escape and an immediate next key as Alt.
    fn escape(&mut self, closes: &str) {
        self.press("\x1b");
        self.wait_while(|screen| screen.contains(closes), &format!("{closes:?} did not go away"));
    }

    fn wait_while(&self, waits: impl Fn(&str) -> bool, failed: &str) {
        let begun = Instant::now();
        while waits(&self.screen()) {
            assert!(begun.elapsed() < TIME_LIMIT, "{failed}:\n{}", self.screen());
            thread::sleep(Duration::from_millis(20));
        }
    }

    fn press(&mut self, keys: &str) {
        self.keys.write_all(keys.as_bytes()).unwrap();
    }

    fn status(&mut self) -> Option<i32> {
        let begun = Instant::now();
        let status = loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                break status;
            }
            assert!(begun.elapsed() < TIME_LIMIT, "the console does not end:\n{}", self.screen());
            thread::sleep(Duration::from_millis(20));
        };
        let after = tcgetattr(&self.slave).unwrap();
        let modes = |of: &Termios| (of.local_modes, of.input_modes, of.output_modes, of.control_modes);
        assert_eq!(modes(&after), modes(&self.before), "the modes of the terminal are not restored");
        status.code()
    }

    fn end(mut self) -> Option<i32> {
        let status = self.status();
        let begun = Instant::now();
        // The parser may not have read the last bytes.
        let is_back = || {
            let parser = locked(&self.parser);
            !parser.screen().alternate_screen() && !parser.screen().hide_cursor()
        };
        while !is_back() {
            assert!(begun.elapsed() < TIME_LIMIT, "the screen is not what it was");
            thread::sleep(Duration::from_millis(20));
        }
        status
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A run in its own thread, which returns the outcome of each step, and the flag that ends it.
type Running = (thread::JoinHandle<Vec<&'static str>>, Arc<AtomicBool>);

/// A run in real time, accelerated by `speed`.
fn run(name: &str, log: &Path, job: &str, speed: u8) -> Running {
    let data = shipped();
    let config = RunConfig {
        clock: ClockKind::Real,
        speed,
        name: Some(name.parse().unwrap()),
        log: LogTarget::File(log.to_owned()),
        ..RunConfig::new(data, job)
    };
    begin(config)
}

/// A run in real time, accelerated by `speed`, with the data `data`. Its job of one command waits for an operator.
fn waiting_run(directory: &Path, data: &Path, name: &str, speed: u8) -> Running {
    let job = directory.join("safe.job");
    std::fs::write(&job, TO_SAFE).unwrap();
    begin(RunConfig {
        clock: ClockKind::Real,
        speed,
        stand_by: true,
        name: Some(name.parse().unwrap()),
        log: LogTarget::File(directory.join("run.mcap")),
        ..RunConfig::new(data, job.to_string_lossy())
    })
}

fn shipped() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../data")
}

fn begin(config: RunConfig) -> Running {
    let name = config.name.clone().unwrap();
    let stop = Arc::clone(&config.stop);
    let run = thread::spawn(move || {
        let outcome = Run::new(config, Box::new(Silent)).unwrap().complete();
        outcome.steps.iter().map(|step| step.outcome.text()).collect()
    });
    // A run exists once it has published its first tick. It listens to operators after that.
    let begun = Instant::now();
    let is_alive = || executive::memory::list().unwrap().iter().any(|run| run.name == name && run.alive);
    let listed = || is_alive() && executive::memory::starting(&name).is_none();
    let listens = || UnixStream::connect(executive::memory::operator_socket(&name)).is_ok();
    while !(listed() && listens()) {
        assert!(begun.elapsed() < TIME_LIMIT, "the run does not begin");
        thread::sleep(Duration::from_millis(50));
    }
    (run, stop)
}

#[test]
fn all_screens_show_a_run_and_then_its_log() {
    let directory = tempfile::tempdir().unwrap();
    let log = directory.path().join("short.mcap");
    let name = format!("console-{}", std::process::id());
    let (run, stop) = run(&name, &log, "linkbar", 1);
    let mut console =
        Terminal::start(&["--run", &name, "--log", log.to_str().unwrap()], directory.path(), &[]);
    console.wait_for(">1 Ladder");
    console.wait_for("VIEWER");
    console.wait_for("T3 Interface");
    for (key, text) in [
        ("2", "rows that fired"),
        ("3", "DEPC link"),
        ("4", "joints, by the resolvers"),
        ("?", "the run is not affected"),
    ] {
        console.press(key);
        console.wait_for(text);
    }
    console.press("x1p");
    console.wait_for(", SHOWN ");
    console.press("p");
    stop.store(true, Ordering::Relaxed);
    run.join().unwrap();
    console.wait_for("-- ENDED");
    console.press("o");
    console.wait_for("LOG [");
    console.wait_for("RECORDED");
    console.press("q");
    assert_eq!(console.end(), Some(0));
}

#[test]
fn operator_jogs_recovers_from_an_emergency_stop_and_finishes() {
    let directory = tempfile::tempdir().unwrap();
    let name = format!("operated-{}", std::process::id());
    let (run, _) = waiting_run(directory.path(), &shipped(), &name, 10);
    let mut console = Terminal::start(&["--run", &name, "--operate"], directory.path(), &[]);
    console.wait_for("the job waits");
    // The robot is stopped on its way.
    console.press(":job go\r");
    console.press(" ");
    console.wait_for("the velocity knob is at 0");
    console.press(":PAUSE\r");
    console.press(" ");
    console.wait_for("the job waits");
    console.wait_for("speed 100 %");
    // Words of board 6: a command of a block, ^C, GO, a listing, a show word.
    console.press("5:863 12 12 LINE-LOAD\r");
    console.wait_for(": line-load 863 12 12");
    console.wait_for("Finished");
    console.press(":^C\r");
    console.wait_for("6 STOPPED");
    console.press(":GO\r");
    console.wait_for("6 runs");
    console.press(":863 LIST\r");
    console.wait_for("12 == PAUSE -- +0 -- 0 +0 -- 0 -- 0");
    console.press(":TAI\r");
    console.wait_for("command-#-in");
    console.escape("command-#-in");
    // Tab completes, and a refusal is shown.
    console.press(":job n\r");
    console.wait_for("refused: job wait, job go or job skip was expected");
    console.escape(">5 Terminal");
    console.press("6");
    console.wait_for("no frame is on");
    // Prim is held, executed once, and released.
    console.press("h");
    console.wait_while(|screen| screen.contains("holds no process"), "Prim is not held");
    console.press("z");
    console.wait_for("joystick step PRIM: tick");
    console.press("h");
    console.wait_for("holds no process");
    console.press("\x1b[A");
    console.wait_for("w t o r switch one on");
    console.press("w");
    console.wait_for("box       WORLD");
    console.press("-");
    console.wait_for("knob 90 %");
    console.press("\x1b[A");
    console.wait_for("joystick stick 192 0 3");
    console.press("+x");
    console.wait_for("knob 100 %");
    console.press("\x1bOP");
    console.wait_for("F1 again presses the E-stop");
    console.press("\x1bOP");
    console.wait_for("the E-stop near the terminals is pressed");
    for request in ["release terminals", "panel fault-reset"] {
        console.press(&format!(":{request}\r"));
        console.wait_for(&format!("{request}: tick"));
    }
    for (request, stage) in [
        ("panel hydraulics enable", "HYD ENABLED"),
        ("panel manual on", "MANUAL"),
        ("panel align", "aligned ******"),
        ("panel auto", "AUTO"),
        ("panel cycle-start", "stage DEPC"),
    ] {
        let begun = Instant::now();
        while !console.screen().contains(stage) {
            assert!(begun.elapsed() < TIME_LIMIT, "{request} has not led to {stage}:\n{}", console.screen());
            console.press(&format!(":{request}\r"));
            thread::sleep(Duration::from_millis(300));
        }
    }
    thread::sleep(Duration::from_secs(2));
    console.press(":job go\r");
    console.wait_for("ENDED");
    console.press("q");
    assert_eq!(console.end(), Some(0));
    let outcomes = run.join().unwrap();
    assert_eq!(outcomes.last(), Some(&"finished"), "{outcomes:?}");
}

fn own_data(directory: &Path) -> PathBuf {
    let data = directory.join("data");
    for from in [shipped(), shipped().join("objects")] {
        let to = data.join(from.strip_prefix(shipped()).unwrap());
        std::fs::create_dir_all(&to).unwrap();
        for file in std::fs::read_dir(from).unwrap().map(|entry| entry.unwrap().path()) {
            if file.is_file() {
                std::fs::copy(&file, to.join(file.file_name().unwrap())).unwrap();
            }
        }
    }
    data
}

/// Move the robot up with the joystick box, record the pose there as VIA-1 of block 610, and move it down again.
fn teach(console: &mut Terminal, pause: Duration) {
    thread::sleep(pause);
    console.press("6ssw");
    console.wait_for("s=2.00 in");
    console.wait_for("box       WORLD");
    thread::sleep(pause);
    console.press("\x1b[5~");
    console.wait_for("joystick up");
    thread::sleep(Duration::from_secs(1));
    thread::sleep(pause);
    console.press("m");
    console.wait_for("joystick record: tick");
    console.wait_for("suspended until carriage return");
    thread::sleep(Duration::from_secs(1));
    thread::sleep(pause);
    console.press("M");
    console.wait_for("joystick resume: tick");
    thread::sleep(Duration::from_secs(1));
    thread::sleep(pause);
    console.press("\x1b[6~");
    console.wait_for("joystick down");
    thread::sleep(Duration::from_secs(1));
    thread::sleep(pause);
    console.press("x");
    console.wait_for("no frame is on");
    thread::sleep(pause);
    console.press("5:^C\r");
    console.wait_for("6 STOPPED");
    thread::sleep(pause);
    console.press(":21000 OFFSET !\r");
    console.wait_for("offset 21000");
    thread::sleep(pause);
    console.press(":610 TEACH VIA-1\r");
    console.wait_for("nearest to its limit");
    console.wait_for("-pose-   ...         VIA-1");
    thread::sleep(pause);
    console.press("\x1bOQ");
    console.wait_for("asks for: load 21000 610");
    thread::sleep(pause);
    console.press("\r");
    console.wait_for("generation 1");
}

/// III.3.3: a via point is taught with the joystick box and added to a trajectory, and the job uses it.
#[test]
fn job_passes_through_a_taught_via_point() {
    let directory = tempfile::tempdir().unwrap();
    let data = own_data(directory.path());
    let name = format!("taught-{}", std::process::id());
    let (run, _) = waiting_run(directory.path(), &data, &name, 10);
    let mut console = Terminal::start(&["--run", &name, "--operate"], directory.path(), &[]);
    console.wait_for("the job waits");
    teach(&mut console, Duration::ZERO);
    console.press(":852 EDIT\r");
    console.wait_for("HOME-SAFE");
    console.press("\x1b[B\x1b[B\x1b[B\x1b[B\x1b[B\x1b[B\x1b[F");
    console.press(&"\x7f".repeat("HOM-SAF-1".len()));
    console.press("VIA-1\x1bOQ");
    console.wait_for("asks for: load 21000 852");
    console.press("\r");
    console.wait_for("generation 2");
    console.press(":GO\r");
    console.wait_for("6 runs");
    console.press(":job go\r");
    console.wait_for("ENDED");
    console.press("q");
    assert_eq!(console.end(), Some(0));
    let outcomes = run.join().unwrap();
    assert_eq!(outcomes.last(), Some(&"finished"), "{outcomes:?}");
    let text = |file: &str| std::fs::read_to_string(data.join(file)).unwrap();
    assert!(text("poses.blk").contains("-pose-   ...         VIA-1"));
    assert!(text("trajectories.blk").contains("pos    VIA-1"));
}

/// IV.4.2 step 3, IV.2.6: the stages of STARTUP, and the record of a pointer, in a run.
#[test]
fn terminal_shows_startup_stages_and_a_pointer_record() {
    let directory = tempfile::tempdir().unwrap();
    let name = format!("startup-{}", std::process::id());
    let (run, _) = waiting_run(directory.path(), &shipped(), &name, 1);
    let mut console = Terminal::start(&["--run", &name, "--operate"], directory.path(), &[]);
    console.wait_for("the job waits");
    console.press("5:STARTUP\r");
    console.wait_for("Aborting... Initiating... Connecting... Finished");
    console.press(":BOARD 2 :S sensor-pose-^-out\r");
    console.wait_for("a pose of Prim");
    console.press("::R\r");
    console.press(":job go\r");
    console.wait_for("ENDED");
    console.press("q");
    assert_eq!(console.end(), Some(0));
    assert_eq!(run.join().unwrap().last(), Some(&"finished"));
}

/// IV.2.1, IV.2.8: the console shows a run that waits for its boards, and the missing boards.
#[test]
fn console_waits_for_a_run_with_missing_boards() {
    let directory = tempfile::tempdir().unwrap();
    let name = format!("boards-{}", std::process::id());
    let config = RunConfig {
        boards: Boards::Manual,
        name: Some(name.parse().unwrap()),
        log: LogTarget::None,
        ..RunConfig::new(shipped(), "linkbar")
    };
    let stop = Arc::clone(&config.stop);
    let run = thread::spawn(move || Run::new(config, Box::new(Silent)).is_err());
    let begun = Instant::now();
    while executive::boards::coming_up(&name.parse().unwrap()).is_none() {
        assert!(begun.elapsed() < TIME_LIMIT, "the run does not wait for its boards");
        thread::sleep(Duration::from_millis(20));
    }
    let mut console = Terminal::start(&["--run", &name, "--operate"], directory.path(), &[]);
    console.wait_for(&format!("The boards of {name} come up"));
    console.wait_for("board 4   MISSING    T3 Interface");
    stop.store(true, Ordering::Relaxed);
    assert!(run.join().unwrap(), "it was interrupted");
    console.wait_for("There is no run on this machine");
    console.press("q");
    assert_eq!(console.end(), Some(0));
}

#[test]
fn operate_is_refused_with_the_reason() {
    let directory = tempfile::tempdir().unwrap();
    let console = Terminal::start(&["--log", "nowhere.mcap", "--operate"], directory.path(), &[]);
    console.wait_for("a log cannot be operated");
    assert_eq!(console.end(), Some(2));
}

#[test]
fn signal_restores_the_terminal() {
    let directory = tempfile::tempdir().unwrap();
    // A directory of its own contains no run.
    for signal in [Signal::TERM, Signal::HUP, Signal::INT] {
        let console = Terminal::start(&["--ascii"], directory.path(), &[("RCS_RUNS", directory.path())]);
        console.wait_for("Looking for runs");
        kill_process(Pid::from_child(&console.child), signal).unwrap();
        assert_eq!(console.end(), Some(0), "{signal:?}");
    }
}

/// ^Z returns the terminal, and the console draws everything again when it continues.
#[test]
fn suspended_console_continues() {
    let directory = tempfile::tempdir().unwrap();
    let state = directory.path();
    let mut console = Terminal::start(&[], state, &[("RCS_RUNS", state)]);
    console.wait_for("Looking for runs");
    let pid = console.child.id();
    let is_stopped = || {
        let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap();
        stat.rsplit(')').next().is_some_and(|rest| rest.trim_start().starts_with('T'))
    };
    console.press("\x1a");
    let begun = Instant::now();
    while !is_stopped() {
        assert!(begun.elapsed() < TIME_LIMIT, "the console continues:\n{}", console.screen());
        thread::sleep(Duration::from_millis(20));
    }
    console.wait_while(|screen| screen.contains("Looking for runs"), "the screen is not what it was");
    kill_process(Pid::from_child(&console.child), Signal::CONT).unwrap();
    console.wait_for("Looking for runs");
    console.press("\x0cq");
    assert_eq!(console.end(), Some(0));
}

#[test]
fn unreadable_source_is_reported_before_the_terminal_changes() {
    let directory = tempfile::tempdir().unwrap();
    let console = Terminal::start(&["--log", "nowhere.mcap"], directory.path(), &[]);
    console.wait_for("rcs-console: nowhere.mcap:");
    assert_eq!(console.end(), Some(2));
    let console = Terminal::start(&["--run", "no-such-run"], directory.path(), &[]);
    console.wait_for("rcs-console: there is no run named no-such-run");
    assert_eq!(console.end(), Some(2));
}

/// The effect of `tmux kill-session` and of a closed window.
#[test]
fn closed_terminal_ends_the_console_at_once() {
    let directory = tempfile::tempdir().unwrap();
    let (master, slave) = open_terminal();
    let mut child = begin_console(&["--ascii"], directory.path(), &[], &slave);
    let (mut screen, mut parser) = (File::from(master), vt100::Parser::new(LINES, COLUMNS, 0));
    while !parser.screen().contents().contains("Looking for runs") {
        let mut bytes = [0; 4096];
        let count = screen.read(&mut bytes).unwrap();
        parser.process(&bytes[..count]);
    }
    drop(screen);
    let begun = Instant::now();
    while child.try_wait().unwrap().is_none() && begun.elapsed() < TIME_LIMIT {
        thread::sleep(Duration::from_millis(20));
    }
    let _ = child.kill();
    let status = child.wait().unwrap();
    assert_eq!(status.code(), Some(1), "after {:?}: {status}", begun.elapsed());
}

#[test]
fn signal_ends_a_console_with_blocked_output() {
    let directory = tempfile::tempdir().unwrap();
    let mut console = Terminal::start(&["--ascii"], directory.path(), &[("RCS_RUNS", directory.path())]);
    console.wait_for("Looking for runs");
    // The same as Ctrl-S: the terminal holds further output back.
    tcflow(&console.slave, Action::OOff).unwrap();
    thread::sleep(Duration::from_millis(300));
    kill_process(Pid::from_child(&console.child), Signal::TERM).unwrap();
    assert_eq!(console.status(), Some(1));
}
