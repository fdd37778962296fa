//! The program with a robot at a serial port: a pseudo-terminal, with the controller of [`depc`] at its other end.

mod common;

use std::{
    fs::{self, File},
    io::{ErrorKind, Read as _, Write as _},
    os::unix::fs::symlink,
    panic::{self, AssertUnwindSafe},
    path::{Path, PathBuf},
    process::{Child, Output, Stdio},
    sync::{
        Arc, RwLock,
        atomic::{AtomicBool, AtomicU16, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs, ControllerState, Refusal, Robot, joints_for},
};
use geometry::kinematics::{HOME_JOINTS, Joints, T3};
use interfaces::device::LinkBytes;
use rustix::{
    fs::OFlags,
    process::{Pid, Signal, kill_process},
    pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt},
    termios::{OptionalActions, tcgetattr, tcsetattr},
};
use serde_json::Value;
use tempfile::TempDir;

use common::command;

struct Place(TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn port(&self) -> PathBuf {
        self.0.path().join("port")
    }

    fn robot(&self) -> String {
        format!("serial:{}", self.port().display())
    }
}

struct Exact {
    joints: Joints,
    at: Plate,
    /// Steps of the last commands, and the longest step: the largest change of a word, 0.01 in or 0.01 degree.
    last: [u16; 3],
    longest: u16,
}

impl Robot for Exact {
    fn present(&mut self) -> Plate {
        self.at
    }

    fn accept(&mut self, goal: &Plate) -> Result<(), Refusal> {
        self.joints = joints_for(&T3, goal, &self.joints)?;
        let changes = goal.words.iter().zip(self.at.words).map(|(to, from)| to.abs_diff(from));
        let step = changes.max().unwrap_or(0);
        (self.last, self.longest) = ([self.last[1], self.last[2], step], self.longest.max(step));
        self.at = *goal;
        Ok(())
    }
}

/// A controller at the other end of a pseudo-terminal. Dropping it hangs up, as a pulled cable does.
struct Peer {
    stop: Arc<AtomicBool>,
    longest: Arc<AtomicU16>, // longest step of the robot
    thread: Option<JoinHandle<(ControllerState, Exact)>>,
}

#[derive(Clone, Copy, Default)]
struct Manner {
    delay: Option<Duration>, // time until it answers, or `None` if it never does
    raised: i16,             // height of the arm above HOME, 0.01 in
    late: Duration,          // time until it is powered up
}

impl Peer {
    /// A controller that answers after `delay`, or never; its port is linked at `link`.
    fn plug(link: &Path, delay: Option<Duration>) -> Self {
        Self::plug_with(link, Manner { delay, ..Manner::default() })
    }

    fn plug_with(link: &Path, manner: Manner) -> Self {
        // A program started by another test must not inherit the master, or closing it would not hang up.
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
        grantpt(&master).unwrap();
        unlockpt(&master).unwrap();
        // A cable has no echo. With echo, bytes sent before the port is open would return.
        let mut settings = tcgetattr(&master).unwrap();
        settings.make_raw();
        tcsetattr(&master, OptionalActions::Now, &settings).unwrap();
        rustix::fs::fcntl_setfl(&master, OFlags::RDWR | OFlags::NONBLOCK).unwrap();
        let _ = fs::remove_file(link);
        symlink(ptsname(&master, Vec::new()).unwrap().into_string().unwrap(), link).unwrap();
        let (stop, longest) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicU16::new(0)));
        let (stopped, shown) = (Arc::clone(&stop), Arc::clone(&longest));
        let thread = thread::spawn(move || control(File::from(master), manner, &stopped, &shown));
        Self { stop, longest, thread: Some(thread) }
    }

    /// Waits until the robot moves.
    fn moves(&self) {
        let begun = Instant::now();
        while self.longest.load(Ordering::Relaxed) <= SLOW {
            assert!(begun.elapsed() < TIME_LIMIT, "the robot does not move");
            thread::sleep(Duration::from_millis(20));
        }
    }

    /// Pull the cable. Returns the last state of the controller.
    fn pull(self) -> ControllerState {
        self.pull_robot().0
    }

    fn pull_robot(mut self) -> (ControllerState, Exact) {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.take().map(|thread| thread.join().unwrap()).unwrap()
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn control(
    mut master: File,
    manner: Manner,
    stop: &AtomicBool,
    longest: &AtomicU16,
) -> (ControllerState, Exact) {
    let Manner { delay, raised, late } = manner;
    let mut at = Plate::from_frame(&T3.forward_plate(&HOME_JOINTS), &Plate::default()).unwrap();
    at.words[2] += raised;
    let mut robot = Exact { joints: HOME_JOINTS, at, last: [0; 3], longest: 0 };
    robot.accept(&at).unwrap();
    let plugged = Instant::now();
    while plugged.elapsed() < late {
        // The cable is not plugged in, so the bytes are lost.
        let _ = master.read(&mut [0; 64]);
        thread::sleep(Duration::from_millis(5));
    }
    let mut controller = Controller::new(Limits::NBS);
    let mut inputs = ControllerInputs { cts: true, board: true, start: true, ..Default::default() };
    let mut stepped = Instant::now();
    while !stop.load(Ordering::Relaxed) {
        inputs.rx = LinkBytes::default();
        match master.read(&mut inputs.rx.bytes) {
            Ok(count) => inputs.rx.length = u8::try_from(count).unwrap(),
            // No data, or no process has the port open.
            Err(error) => assert!(error.kind() == ErrorKind::WouldBlock || error.raw_os_error() == Some(5)),
        }
        // Silence is a separate step, because it ends a torn frame.
        if inputs.rx.length == 0 && stepped.elapsed() < Duration::from_millis(20) {
            thread::sleep(Duration::from_millis(1));
            continue;
        }
        stepped = Instant::now();
        let answer = controller.step(&inputs, &mut robot).tx;
        longest.store(robot.longest, Ordering::Relaxed);
        inputs.start = false;
        if let Some(delay) = delay.filter(|_| answer.length > 0) {
            thread::sleep(delay);
            let _ = master.write(answer.as_slice());
        }
    }
    (controller.state(), robot)
}

fn rcs_run(arguments: &[&str]) -> Output {
    command(arguments).output().unwrap()
}

fn last_words(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).lines().last().unwrap_or_default().to_owned()
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {output:?}"))
}

fn link_test(place: &Place, seconds: &str) -> (Output, Value) {
    let output = rcs_run(&["link-test", "--robot", &place.robot(), "--seconds", seconds, "--json"]);
    let tally = json(&output);
    (output, tally)
}

/// Play the linkbar with the robot of a place for a number of ticks.
fn linkbar(place: &Place, ticks: &str) -> (Output, Value) {
    let output = rcs_run(&[
        "linkbar",
        "--robot",
        &place.robot(),
        "--clock",
        "real",
        "--ticks",
        ticks,
        "--json",
        "--log",
        "none",
        "--shared-memory",
        "off",
    ]);
    let result = json(&output);
    (output, result)
}

const TIME_LIMIT: Duration = Duration::from_secs(60); // of each action, for a busy machine
const SLOW: u16 = 10; // a step of 0.1 in: 2.5 in/s
const PROMPT: Option<Duration> = Some(Duration::from_millis(2));
/// Attempts of a test on the 40 ms grid. Other load may delay a frame in one attempt; a real error recurs in each.
const ATTEMPTS: u32 = 5;

fn on_the_grid(attempt: impl Fn()) {
    static ALONE: RwLock<()> = RwLock::new(());
    let is_held_up = || panic::catch_unwind(AssertUnwindSafe(&attempt)).is_err();
    let beside = ALONE.read();
    if !is_held_up() {
        return;
    }
    drop(beside);
    let _alone = ALONE.write();
    if (2..ATTEMPTS).all(|_| is_held_up()) {
        attempt();
    }
}

#[test]
fn answering_link_is_good() {
    on_the_grid(|| {
        let place = Place::new();
        let peer = Peer::plug(&place.port(), PROMPT);
        let (output, tally) = link_test(&place, "3");
        assert_eq!(output.status.code(), Some(0), "{tally} {}", last_words(&output));
        assert!(tally["sent"].as_u64().unwrap() > 40, "{tally}");
        assert_eq!(
            (&tally["refused"], &tally["lost"], &tally["starts"]),
            (&0.into(), &0.into(), &1.into()),
            "{tally}"
        );
        assert!(tally["ack_ms"]["min"].as_f64().unwrap() >= 2.0, "{tally}");
        assert_eq!(
            peer.pull(),
            ControllerState::Running,
            "nothing was asked that the controller complains of"
        );
    });
}

#[test]
fn dump_shows_every_frame() {
    on_the_grid(|| {
        let place = Place::new();
        let _peer = Peer::plug(&place.port(), PROMPT);
        let output = rcs_run(&["link-test", "--robot", &place.robot(), "--seconds", "2", "--dump"]);
        let text = String::from_utf8(output.stdout).unwrap();
        let lines = |end: &str| text.lines().filter(|line| line.ends_with(end)).count();
        assert!(text.contains("< FF FF 03 00 00 E7 6B") && lines("report") >= 1, "{text}");
        assert!(text.contains("> 03 00 00 00 00 E7 6B"), "the reported position is held: {text}");
        assert!(lines("data") > 10 && lines("ACK") >= lines("data") - 1, "{text}");
    });
}

#[test]
fn dump_without_a_reader_ends_quietly() {
    on_the_grid(|| {
        let place = Place::new();
        let _peer = Peer::plug(&place.port(), PROMPT);
        let mut child = command(&["link-test", "--robot", &place.robot(), "--seconds", "2", "--dump"])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = [0; 16];
        child.stdout.take().unwrap().read_exact(&mut line).unwrap();
        let output = child.wait_with_output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{said}");
        assert!(!said.contains("panicked") && !said.contains("Broken pipe"), "{said}");
    });
}

#[test]
fn late_link_is_not_usable() {
    on_the_grid(|| {
        let place = Place::new();
        let _peer = Peer::plug(&place.port(), Some(Duration::from_millis(60)));
        let (output, tally) = link_test(&place, "2");
        assert_eq!((output.status.code(), &tally["verdict"]), (Some(1), &"not-usable".into()), "{tally}");
        assert!(tally["acknowledged"].as_u64().unwrap() > 5 && tally["in_time"] == 0, "{tally}");
        assert!(last_words(&output).contains("not usable"), "{}", last_words(&output));
    });
}

#[test]
fn port_without_peer_has_no_link() {
    on_the_grid(|| {
        let place = Place::new();
        let _peer = Peer::plug(&place.port(), None);
        let (output, tally) = link_test(&place, "1");
        assert_eq!((output.status.code(), &tally["verdict"]), (Some(3), &"no-link".into()), "{tally}");
        assert!(last_words(&output).contains("has not reported"), "{}", last_words(&output));
        let absent = rcs_run(&["link-test", "--robot", "serial:/dev/none"]);
        assert_eq!(absent.status.code(), Some(3));
        assert!(last_words(&absent).contains("no serial port /dev/none"), "{}", last_words(&absent));
    });
}

#[test]
fn unplugged_port_is_reopened() {
    on_the_grid(|| {
        let place = Place::new();
        let first = Peer::plug(&place.port(), PROMPT);
        let link = place.port();
        let hands = thread::spawn(move || {
            thread::sleep(Duration::from_millis(1500));
            first.pull();
            thread::sleep(Duration::from_millis(300));
            // The arm was moved meanwhile. Sending the old position would cause a jump of 2 in, and a warning.
            Peer::plug_with(&link, Manner { delay: PROMPT, raised: 200, ..Manner::default() })
        });
        let (output, tally) = link_test(&place, "6");
        assert_eq!(output.status.code(), Some(0), "{tally} {}", last_words(&output));
        assert_eq!((&tally["port_lost"], &tally["starts"]), (&1.into(), &2.into()), "{tally}");
        assert!(tally["lost"].as_u64().unwrap() <= 1, "{tally}");
        assert_eq!(hands.join().unwrap().pull(), ControllerState::Running, "it was not asked to jump back");
    });
}

#[test]
fn linkbar_begins_over_a_port_in_real_time() {
    on_the_grid(|| {
        let place = Place::new();
        let peer = Peer::plug(&place.port(), PROMPT);
        let (output, result) = linkbar(&place, "250");
        assert_eq!(output.status.code(), Some(0), "{}", last_words(&output));
        let link = &result["link"];
        assert!(link["frames"].as_u64().unwrap() > 200, "{link}");
        assert_eq!((&link["naks"], &link["checksum_errors"]), (&0.into(), &0.into()), "{link}");
        assert_eq!(result["allocations_after_start"], 0);
        assert_eq!(result["commands"][0]["status"], "finished", "{result}");
        assert!(result["port"]["sent"].as_u64().unwrap() > 200 * 16, "{result}");
        assert_eq!(peer.pull(), ControllerState::Running, "no velocity or joint limit was touched");
    });
}

/// LOAD (IV.2.4): the block is read and checked while frames continue, and the next command uses it.
#[test]
fn block_is_loaded_while_the_link_runs() {
    on_the_grid(|| {
        let place = Place::new();
        let own = place.0.path().join("data");
        common::data::copy(&common::root().join("data"), &own);
        let peer = Peer::plug(&place.port(), PROMPT);
        let (robot, data_text) = (place.robot(), own.display().to_string());
        let name = format!("port-load-{}", std::process::id());
        let run = [
            ["linkbar", "--stand-by", "--json"].as_slice(),
            &["--robot", &robot, "--clock", "real", "--data", &data_text, "--run", &name, "--log", "none"],
        ];
        let child = command(&run.concat()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let ask = |line: &str, expected: &str| {
            let begun = Instant::now();
            loop {
                let output = rcs_run(&["send", "--run", &name, line]);
                let said = [output.stdout, output.stderr].concat();
                let said = String::from_utf8_lossy(&said).into_owned();
                if said.contains(expected) {
                    return;
                }
                assert!(begun.elapsed() < TIME_LIMIT, "{line}: {expected:?} was expected: {said}");
                thread::sleep(Duration::from_millis(100));
            }
        };
        ask("status", "the job waits");
        ask("line-load 863 5 5", "refused");
        // Line 5 is new: PAUSE.
        let commands = own.join("commands.blk");
        let text = fs::read_to_string(&commands).unwrap();
        let safe = "== MOVE -- +0 -- 0 +0 SAFE 0 -- 0\n";
        let longer = format!("{safe}== PAUSE -- +0 -- 0 +0 -- 0 -- 0");
        fs::write(&commands, text.replace(safe, &longer)).unwrap();
        ask("load 16000 863", "generation 1");
        ask("line-load 863 5 5", "command ");
        // A block with an error is reported, and changes nothing.
        fs::write(&commands, text.replace(safe, "== NONSENSE\n")).unwrap();
        ask("load 16000 863", "the task data have errors");
        ask("line-load 863 5 5", "command ");
        send(&child, Signal::TERM);
        let output = child.wait_with_output().unwrap();
        let result = json(&output);
        let link = &result["link"];
        assert_eq!(
            (&link["naks"], &link["checksum_errors"], &link["retries"]),
            (&0.into(), &0.into(), &0.into()),
            "{link}"
        );
        assert_eq!(result["allocations_after_start"], 0, "{result}");
        assert_eq!(peer.pull(), ControllerState::Running, "the link has not stopped meanwhile");
    });
}

fn moving(place: &Place, peer: &Peer) -> Child {
    let robot = place.robot();
    let run = [
        "linkbar",
        "--robot",
        &robot,
        "--clock",
        "real",
        "--json",
        "--log",
        "none",
        "--shared-memory",
        "off",
    ];
    let child = command(&run).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    peer.moves();
    child
}

fn send(child: &Child, signal: Signal) {
    kill_process(Pid::from_child(child), signal).unwrap();
}

/// The stream of points ends at rest for every end of a run.
#[test]
fn signal_stops_the_robot_before_the_run_ends() {
    thread::scope(|all| {
        for (signal, word) in [(Signal::TERM, "SIGTERM"), (Signal::INT, "SIGINT"), (Signal::HUP, "SIGHUP")] {
            all.spawn(move || on_the_grid(|| a_signal_brings_it_to_rest(signal, word)));
        }
    });
}

fn a_signal_brings_it_to_rest(signal: Signal, word: &str) {
    let place = Place::new();
    let peer = Peer::plug(&place.port(), PROMPT);
    let child = moving(&place, &peer);
    send(&child, signal);
    let output = child.wait_with_output().unwrap();
    let result = json(&output);
    assert_eq!(output.status.code(), Some(3), "{word}: {}", last_words(&output));
    assert!(last_words(&output).contains("stopped by the user"), "{word}: {}", last_words(&output));
    assert!(result["ramp_ticks"].as_u64() > Some(0), "{word}: {result}");
    let (state, robot) = peer.pull_robot();
    assert_eq!((state, robot.last), (ControllerState::Running, [0; 3]), "{word}");
    assert!(robot.longest > SLOW, "{word}: it moved by more than 2.5 in/s, {}", robot.longest);
}

#[test]
fn last_tick_over_a_port_is_followed_by_a_ramp() {
    on_the_grid(|| {
        let place = Place::new();
        let peer = Peer::plug(&place.port(), PROMPT);
        let (output, result) = linkbar(&place, "200");
        assert_eq!(output.status.code(), Some(0), "{}", last_words(&output));
        assert_eq!(result["ticks"], 200);
        assert!(result["ramp_ticks"].as_u64() > Some(0), "{result}");
        let (state, robot) = peer.pull_robot();
        assert_eq!((state, robot.last), (ControllerState::Running, [0; 3]));
        assert!(robot.longest > SLOW, "it moved by more than 2.5 in/s, {}", robot.longest);
    });
}

/// `timeout` and shells send two signals at once.
#[test]
fn two_signals_within_a_second_stop_the_run_in_order() {
    on_the_grid(|| {
        let place = Place::new();
        let peer = Peer::plug(&place.port(), PROMPT);
        let child = moving(&place, &peer);
        send(&child, Signal::TERM);
        send(&child, Signal::INT);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(3), "{}", last_words(&output));
        assert!(!output.stdout.is_empty(), "the result is printed");
    });
}

/// The robot controller starts 3 s after the host.
#[test]
fn run_waits_for_a_robot_controller_powered_up_later() {
    let late = Manner { delay: PROMPT, late: Duration::from_secs(3), ..Manner::default() };
    let linkbar = |place: &Place, wait: &str| {
        let robot = format!("{},silence=1", place.robot());
        let real = ["--clock", "real", "--ticks", "250", "--log", "none", "--shared-memory", "off", "--json"];
        rcs_run(&[&["linkbar", "--robot", &robot, "--wait", wait], &real[..]].concat())
    };
    on_the_grid(|| {
        let place = Place::new();
        let peer = Peer::plug_with(&place.port(), late);
        let output = linkbar(&place, "30");
        assert_eq!(output.status.code(), Some(0), "{}", last_words(&output));
        assert_eq!(json(&output)["commands"][0]["status"], "finished");
        assert_eq!(peer.pull(), ControllerState::Running);
    });
    let place = Place::new();
    let _peer = Peer::plug(&place.port(), None);
    let output = linkbar(&place, "1");
    assert_eq!(output.status.code(), Some(3), "{}", last_words(&output));
}

#[test]
fn pulled_cable_ends_the_run_with_its_reason() {
    on_the_grid(|| {
        let place = Place::new();
        let peer = Peer::plug(&place.port(), PROMPT);
        let hands = thread::spawn(move || {
            peer.moves();
            peer.pull()
        });
        let (output, result) = linkbar(&place, "400");
        assert_eq!(hands.join().unwrap(), ControllerState::Running);
        assert_eq!(output.status.code(), Some(3), "{result}");
        let words = last_words(&output);
        assert!(
            words.contains("has disappeared; then, at tick ")
                && words.contains("T3 Interface: not responding"),
            "{words}"
        );
        assert_eq!(result["port"]["losses"], 1, "{result}");
        assert_eq!(result["allocations_after_start"], 0);
    });
}

#[test]
fn contradictory_options_are_refused_at_once() {
    for (arguments, says) in [
        (&["--robot", "serial:/dev/none", "--clock", "real"][..], "no serial port /dev/none"),
        (
            &["--robot", "serial:/dev/none", "--clock", "real", "--faults", "data/faults/noisy-line.toml"],
            "leave them out for any other robot",
        ),
        (&["--faults", "/none.toml"], "/none.toml"),
        (&["link-test", "--robot", "sim"], "serial:PATH"),
    ] {
        let output = rcs_run(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(last_words(&output).contains(says), "{arguments:?}: {}", last_words(&output));
    }
}

#[test]
fn injected_faults_are_counted_and_survived() {
    let place = Place::new();
    let plan = place.0.path().join("plan.toml");
    fs::write(
        &plan,
        "seed = 3\n[[fault]]\nkind = \"flip\"\ndirection = \"to-controller\"\nat = 100\n\
         [[fault]]\nkind = \"flip\"\ndirection = \"to-controller\"\nat = 140\n",
    )
    .unwrap();
    let plan = plan.to_str().unwrap();
    let run = || {
        rcs_run(&["--faults", plan, "--ticks", "200", "--json", "--log", "none", "--shared-memory", "off"])
    };
    let output = run();
    let result = json(&output);
    assert_eq!(output.status.code(), Some(0), "{result} {}", last_words(&output));
    // A fault without a rate affects every byte of its tick.
    assert_eq!(result["faults"]["kinds"]["flip"], 32, "{result}");
    assert_eq!(json(&run())["digest"], result["digest"], "the same plan gives the same run");
}
