//! Tests the program from outside: as a host and as a person at the console.

use std::{
    fs::{self, File, OpenOptions},
    io::{BufRead, BufReader, Read, Write},
    os::unix::fs::OpenOptionsExt,
    path::{Path, PathBuf},
    process::{Child, ChildStdin, Command, ExitStatus, Stdio},
    sync::mpsc::{Receiver, channel},
    thread,
    time::{Duration, Instant},
};

use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    process::{Pid, Signal, kill_process},
};
use tempfile::TempDir;

const TIME_LIMIT: Duration = Duration::from_secs(30); // generous time limit for a busy machine

/// The position report at HOME, byte by byte.
const HOME: [u8; 16] =
    [0xFF, 0xFF, 0x03, 0x00, 0x00, 0xE7, 0x6B, 0xFD, 0x84, 0xDC, 0xD8, 0x34, 0xBC, 0x00, 0x00, 0x7A];
/// The data command for a position 0.10 in away from HOME.
const MOVED_FRAME: [u8; 16] =
    [0x03, 0x00, 0x00, 0x00, 0x0A, 0xE7, 0x6B, 0xFD, 0x84, 0xDC, 0xD8, 0x34, 0xBC, 0x00, 0x00, 0x70];
/// The position report at that position.
const MOVED_REPORT: [u8; 16] =
    [0xFF, 0xFF, 0x03, 0x00, 0x0A, 0xE7, 0x6B, 0xFD, 0x84, 0xDC, 0xD8, 0x34, 0xBC, 0x00, 0x00, 0x70];

struct Place(TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn link(&self) -> PathBuf {
        self.0.path().join("t3")
    }
}

struct Cell {
    child: Child,
    console: ChildStdin,
    screen: Receiver<String>,
}

impl Cell {
    fn start(link: &Path, options: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_rcs-cell"))
            .arg("--link")
            .arg(link)
            .args(options)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let (send, screen) = channel();
        let out = BufReader::new(child.stdout.take().unwrap());
        thread::spawn(move || {
            for line in out.lines().map_while(Result::ok) {
                if send.send(line).is_err() {
                    break;
                }
            }
        });
        Self { console: child.stdin.take().unwrap(), child, screen }
    }

    fn enter(&mut self, line: &str) {
        writeln!(self.console, "{line}").unwrap();
    }

    /// Waits for a line that contains `text`; returns the lines up to it.
    fn wait_for(&self, text: &str) -> Vec<String> {
        let mut seen = Vec::new();
        let end = Instant::now() + TIME_LIMIT;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            match self.screen.recv_timeout(left) {
                Ok(line) => seen.push(line),
                Err(error) => panic!("{text:?} did not come ({error}), but {seen:#?}"),
            }
            if seen.last().is_some_and(|line| line.contains(text)) {
                return seen;
            }
        }
    }

    fn signal(&self, signal: Signal) {
        let pid = Pid::from_child(&self.child);
        kill_process(pid, signal).unwrap();
    }

    fn ended(&mut self) -> ExitStatus {
        let end = Instant::now() + TIME_LIMIT;
        loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                return status;
            }
            assert!(Instant::now() < end, "it does not end");
            thread::sleep(Duration::from_millis(5));
        }
    }
}

impl Drop for Cell {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A host that opens the link as a plain file, because the terminal is already raw.
struct Host(File);

impl Host {
    fn open(link: &Path) -> Self {
        let mut options = OpenOptions::new();
        options.read(true).write(true).custom_flags(rustix::fs::OFlags::NOCTTY.bits().cast_signed());
        Self(options.open(link).unwrap())
    }

    fn send(&mut self, bytes: &[u8]) {
        self.0.write_all(bytes).unwrap();
    }

    fn receive<const N: usize>(&mut self) -> [u8; N] {
        let (mut bytes, mut length) = ([0; N], 0);
        let end = Instant::now() + TIME_LIMIT;
        while length < N {
            let left = end.saturating_duration_since(Instant::now());
            assert!(!left.is_zero(), "only {:02X?} came", &bytes[..length]);
            let mut fds = [PollFd::new(&self.0, PollFlags::IN)];
            if poll(&mut fds, Some(&Timespec::try_from(left).unwrap())).unwrap() > 0 {
                length += self.0.read(&mut bytes[length..]).unwrap();
            }
        }
        bytes
    }
}

#[test]
fn restarted_host_finds_the_robot_in_place() {
    let place = Place::new();
    let mut cell = Cell::start(&place.link(), &["--auto"]);
    cell.wait_for("waits for a host");
    let mut host = Host::open(&place.link());
    assert_eq!(host.receive(), HOME);
    host.send(&MOVED_FRAME);
    assert_eq!(host.receive(), [0x06]);
    let mut garbled = MOVED_FRAME;
    garbled[4] = 0x0B;
    host.send(&garbled);
    assert_eq!(host.receive(), [0x15]);
    let sent = Instant::now();
    host.send(&[0x05]);
    assert_eq!(host.receive(), MOVED_REPORT);
    // Seventeen bytes at 9600 baud; a busy machine can only take longer.
    assert!(sent.elapsed() >= Duration::from_micros(17 * 1041), "{:?}", sent.elapsed());

    drop(host);
    cell.wait_for("WD1  CTS low");
    let mut host = Host::open(&place.link());
    assert_eq!(host.receive(), MOVED_REPORT);
    host.send(&MOVED_FRAME);
    assert_eq!(host.receive(), [0x06]);
    cell.signal(Signal::TERM);
    assert_eq!(cell.ended().code(), Some(0));
    assert!(place.link().symlink_metadata().is_err(), "the link is removed");
}

#[test]
fn manual_start_up_recovers_from_a_wd_error() {
    let place = Place::new();
    let mut cell = Cell::start(&place.link(), &["--seed", "3"]);
    cell.wait_for("waits for a host");
    cell.enter("cycle start");
    cell.wait_for("refused: the controller has no power");
    for (command, answer) in [
        ("control power on", "FAULT RESET on"),
        ("fault reset", "FAULT RESET off"),
        ("manual on", "refused: the HYDRAULICS keyswitch is not at ENABLE"),
        ("hydraulics enable", "HYD ENABLED on"),
        ("manual on", "the hand has jumped by"),
        ("auto", "refused: not all axes are aligned"),
        ("align", " * * * * * *"),
        ("auto", "HOME, to within"),
        ("cycle start", "WD1  CTS low"),
        ("interrupt\ncancel", "P-IG"),
        ("cancel", "pre-manual mode"),
    ] {
        cell.enter(command);
        cell.wait_for(answer);
    }
    let mut host = Host::open(&place.link());
    cell.wait_for("a host has opened the link");
    cell.enter("auto");
    cell.wait_for("HOME, to within");
    cell.enter("cycle start");
    assert_eq!(host.receive(), HOME);
    cell.enter("estop");
    cell.wait_for("the arm sinks");
    cell.enter("status");
    cell.wait_for("[status] fault");
    cell.enter("quit");
    assert_eq!(cell.ended().code(), Some(0));
    assert!(place.link().symlink_metadata().is_err());
}

#[test]
fn stale_link_is_replaced_and_one_in_use_is_kept() {
    let place = Place::new();
    let mut first = Cell::start(&place.link(), &[]);
    first.wait_for("waits for a host");
    let refused = |link: &Path| {
        let output = Command::new(env!("CARGO_BIN_EXE_rcs-cell")).arg("--link").arg(link).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (status, reason) = refused(&place.link());
    assert_eq!(status, Some(2));
    assert!(reason.contains("still runs"), "{reason}");
    first.signal(Signal::KILL);
    first.ended();
    assert!(place.link().symlink_metadata().is_ok(), "it could not be removed");
    let second = Cell::start(&place.link(), &[]);
    second.wait_for("waits for a host");

    let file = place.0.path().join("file");
    fs::write(&file, "precious").unwrap();
    let (status, reason) = refused(&file);
    assert_eq!(status, Some(2));
    assert!(reason.contains("not a link that rcs-cell has left behind"), "{reason}");
    assert_eq!(fs::read_to_string(&file).unwrap(), "precious");
}

#[test]
fn faults_spoil_the_line_and_a_useless_plan_is_refused() {
    let place = Place::new();
    let plan = place.0.path().join("faults.toml");
    fs::write(&plan, "[[fault]]\nkind = \"flip\"\ndirection = \"to-controller\"\nrate = 1.0\n").unwrap();
    let option = format!("--faults={}", plan.display());
    let mut cell = Cell::start(&place.link(), &["--auto", &option]);
    cell.wait_for("waits for a host");
    let mut host = Host::open(&place.link());
    assert_eq!(host.receive(), HOME);
    host.send(&MOVED_FRAME);
    assert_eq!(host.receive(), [0x15]);
    cell.enter("status");
    cell.wait_for("16 faults on the line");
    cell.enter("quit");
    assert_eq!(cell.ended().code(), Some(0));

    for (text, says) in [
        ("[[fault]]\nkind = \"cts-low\"\ndirection = \"to-host\"\nat = 5\n", "modem lines"),
        ("[[fault]]\nkind = \"melt\"\nat = 5\n", "melt"),
    ] {
        fs::write(&plan, text).unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_rcs-cell"))
            .arg("--link")
            .arg(place.link())
            .arg(&option)
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains(says), "{output:?}");
    }
}
