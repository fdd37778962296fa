//! The program with a robot at a serial port: over a pseudo-terminal, with the controller of [`depc`] behind it.

use std::{
    fs::{self, File},
    io::{ErrorKind, Read as _, Write as _},
    os::unix::fs::symlink,
    panic::{self, AssertUnwindSafe},
    path::{Path, PathBuf},
    process::{Command, Output},
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs, ControllerState, JointProblem, Robot, joints_for},
};
use rcs_core::{
    interface::device::LinkBytes,
    kinematics::{HOME_JOINTS, Joints, T3},
};
use rustix::{
    fs::OFlags,
    pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt},
    termios::{OptionalActions, tcgetattr, tcsetattr},
};
use serde_json::Value;
use tempfile::TempDir;

/// A directory of one test, removed with it.
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// Where the port is linked.
    fn port(&self) -> PathBuf {
        self.0.path().join("port")
    }

    fn robot(&self) -> String {
        format!("serial:{}", self.port().display())
    }
}

/// A robot that is where it is told to be.
struct Exact {
    joints: Joints,
    at: Plate,
}

impl Robot for Exact {
    fn present(&self) -> Plate {
        self.at
    }

    fn move_to(&mut self, goal: &Plate) -> Result<(), JointProblem> {
        self.joints = joints_for(&T3, goal, &self.joints)?;
        self.at = *goal;
        Ok(())
    }
}

/// A controller behind a pseudo-terminal. Dropped, it hangs up: the cable is pulled.
struct Peer {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<ControllerState>>,
}

impl Peer {
    /// A controller that answers after `delay`, or never; its port is linked at `link`.
    fn plug(link: &Path, delay: Option<Duration>) -> Self {
        Self::plug_raised(link, delay, 0)
    }

    /// The same, with the arm so many hundredths of an inch above HOME.
    fn plug_raised(link: &Path, delay: Option<Duration>, raised: i16) -> Self {
        // A program that another test starts meanwhile must not inherit it, or it would not hang up.
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC).unwrap();
        grantpt(&master).unwrap();
        unlockpt(&master).unwrap();
        // A cable has no echo: what is said before anybody opens the port would come back.
        let mut settings = tcgetattr(&master).unwrap();
        settings.make_raw();
        tcsetattr(&master, OptionalActions::Now, &settings).unwrap();
        rustix::fs::fcntl_setfl(&master, OFlags::RDWR | OFlags::NONBLOCK).unwrap();
        let _ = fs::remove_file(link);
        symlink(ptsname(&master, Vec::new()).unwrap().into_string().unwrap(), link).unwrap();
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = Arc::clone(&stop);
        let thread = thread::spawn(move || control(File::from(master), delay, raised, &stopped));
        Self { stop, thread: Some(thread) }
    }

    /// Pull the cable; the state in which the controller was.
    fn pull(mut self) -> ControllerState {
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

fn control(mut master: File, delay: Option<Duration>, raised: i16, stop: &AtomicBool) -> ControllerState {
    let mut at = Plate::from_frame(&T3.forward_plate(&HOME_JOINTS), &Plate::default()).unwrap();
    at.words[2] += raised;
    let mut robot = Exact { joints: HOME_JOINTS, at };
    robot.move_to(&at).unwrap();
    let mut controller = Controller::new(Limits::NBS);
    let mut inputs = ControllerInputs { cts: true, board: true, start: true, ..Default::default() };
    let mut stepped = Instant::now();
    while !stop.load(Ordering::Relaxed) {
        inputs.rx = LinkBytes::default();
        match master.read(&mut inputs.rx.bytes) {
            Ok(count) => inputs.rx.length = u8::try_from(count).unwrap(),
            // Nothing there, or nobody has the port open.
            Err(error) => assert!(error.kind() == ErrorKind::WouldBlock || error.raw_os_error() == Some(5)),
        }
        // Silence is a step of its own: it ends a torn frame.
        if inputs.rx.length == 0 && stepped.elapsed() < Duration::from_millis(20) {
            thread::sleep(Duration::from_millis(1));
            continue;
        }
        stepped = Instant::now();
        let answer = controller.step(&inputs, &mut robot).tx;
        inputs.start = false;
        if let Some(delay) = delay.filter(|_| answer.length > 0) {
            thread::sleep(delay);
            let _ = master.write(answer.as_slice());
        }
    }
    controller.state()
}

/// Run the program to its end.
fn rcs_run(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rcs-run"))
        .args(arguments)
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
        .output()
        .unwrap()
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

/// Play the linkbar with the robot of a place, for so many ticks.
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

const PROMPT: Option<Duration> = Some(Duration::from_millis(2));
/// How often a test on the 40 ms grid is begun. A machine that has other things to do may hold up a frame; what is wrong is wrong
/// every time.
const ATTEMPTS: u32 = 5;

/// Try something on the 40 ms grid, with nothing else of this file beside it.
fn on_the_grid(attempt: impl Fn()) {
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _alone = ONE_AT_A_TIME.lock();
    let held_up = (1..ATTEMPTS).all(|_| panic::catch_unwind(AssertUnwindSafe(&attempt)).is_err());
    if held_up {
        attempt();
    }
}

#[test]
fn a_link_that_answers_is_good() {
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
fn the_dump_shows_every_frame() {
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
fn a_link_that_is_late_is_not_usable() {
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
fn nobody_at_the_port_is_no_link() {
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
fn a_port_that_is_unplugged_comes_back() {
    on_the_grid(|| {
        let place = Place::new();
        let first = Peer::plug(&place.port(), PROMPT);
        let link = place.port();
        let hands = thread::spawn(move || {
            thread::sleep(Duration::from_millis(1500));
            first.pull();
            thread::sleep(Duration::from_millis(300));
            // Meanwhile the arm was led elsewhere: the old position would be a leap of 2 in, and a warning.
            Peer::plug_raised(&link, PROMPT, 200)
        });
        let (output, tally) = link_test(&place, "6");
        assert_eq!(output.status.code(), Some(0), "{tally} {}", last_words(&output));
        assert_eq!((&tally["port_lost"], &tally["starts"]), (&1.into(), &2.into()), "{tally}");
        assert!(tally["lost"].as_u64().unwrap() <= 1, "{tally}");
        assert_eq!(hands.join().unwrap().pull(), ControllerState::Running, "it was not asked to jump back");
    });
}

#[test]
fn the_linkbar_begins_over_a_port_in_real_time() {
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

#[test]
fn a_pulled_cable_ends_the_run_with_its_reason() {
    on_the_grid(|| {
        let place = Place::new();
        let peer = Peer::plug(&place.port(), PROMPT);
        let hands = thread::spawn(move || {
            thread::sleep(Duration::from_secs(6));
            peer.pull()
        });
        let (output, result) = linkbar(&place, "400");
        assert_eq!(hands.join().unwrap(), ControllerState::Running);
        assert_eq!(output.status.code(), Some(3), "{result}");
        let words = last_words(&output);
        assert!(
            words.contains("has disappeared; T3 Interface") && words.contains("not responding"),
            "{words}"
        );
        assert_eq!(result["port"]["losses"], 1, "{result}");
        assert_eq!(result["allocations_after_start"], 0);
    });
}

#[test]
fn what_does_not_go_together_is_refused_at_once() {
    for (arguments, says) in [
        (&["--robot", "serial:/dev/none", "--clock", "real"][..], "no serial port /dev/none"),
        (
            &["--robot", "serial:/dev/none", "--clock", "real", "--faults", "data/faults/noisy-line.toml"],
            "a serial port has faults of its own",
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
    // Without a rate a fault strikes every byte of its tick.
    assert_eq!(result["faults"]["kinds"]["flip"], 32, "{result}");
    assert_eq!(json(&run())["digest"], result["digest"], "the same plan gives the same run");
}
