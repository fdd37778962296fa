//! `rcs-cell --station` from outside: a Modbus client in a few bytes, and a person at the cell.

use std::{
    fs,
    io::{BufRead, BufReader, Read, Write},
    net::{SocketAddr, TcpListener, TcpStream},
    path::PathBuf,
    process::{Child, ChildStdin, Command, Stdio},
    sync::mpsc::{Receiver, channel},
    thread,
    time::{Duration, Instant},
};

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

const TIME_LIMIT: Duration = Duration::from_secs(60); // generous time limit for a busy machine
const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../data");
const OUTPUTS: u16 = 0x800; // the register of the outputs of the fixture, and two of their bits
const VISE_PARTIAL: u16 = 1 << 1;
const VISE_CLOSE: u16 = 1 << 2;
const OPENED: u16 = 1 << 0; // bits of register 3 of its inputs
const PARTIAL: u16 = 1 << 1;
const CLAMPED: u16 = 1 << 2;
const TRAY: u16 = 1 << 3; // the bit of `tray.UNIT_1.4` in register 4

struct Station {
    child: Child,
    console: ChildStdin,
    screen: Receiver<String>,
    fixture: SocketAddr,
    _directory: tempfile::TempDir,
}

impl Station {
    fn start() -> Self {
        Self::start_with(&[], |text| text)
    }

    /// A station with more options, and a change of its mapping.
    fn start_with(options: &[&str], change: impl FnOnce(String) -> String) -> Self {
        let directory = tempfile::tempdir().unwrap();
        let path: PathBuf = directory.path().join("free.toml");
        let mut text = fs::read_to_string(format!("{DATA}/field/station.toml")).unwrap();
        let listeners = [21502, 21503, 21504].map(|_| TcpListener::bind("127.0.0.1:0").unwrap());
        let free = listeners.map(|listener| listener.local_addr().unwrap());
        for (shipped, free) in [21502, 21503, 21504].into_iter().zip(free) {
            text = text.replace(&format!("127.0.0.1:{shipped}"), &free.to_string());
        }
        fs::write(&path, change(text)).unwrap();
        let mut child = Command::new(env!("CARGO_BIN_EXE_rcs-cell"))
            .args(["--data", DATA, "--station"])
            .arg(&path)
            .args(options)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let console = child.stdin.take().unwrap();
        let (lines, screen) = channel();
        let output = BufReader::new(child.stdout.take().unwrap());
        thread::spawn(move || output.lines().map_while(Result::ok).try_for_each(|line| lines.send(line)));
        let station = Self { child, console, screen, fixture: free[1], _directory: directory };
        station.wait_for("[station] ready: arm 127.0.0.1:");
        station
    }

    fn wait_for(&self, beginning: &str) -> String {
        let begun = Instant::now();
        while begun.elapsed() < TIME_LIMIT {
            match self.screen.recv_timeout(TIME_LIMIT) {
                Ok(line) if line.starts_with(beginning) => return line,
                Ok(_) => {}
                Err(_) => break,
            }
        }
        panic!("{beginning:?} was not printed");
    }

    fn enter(&mut self, line: &str) {
        writeln!(self.console, "{line}").unwrap();
    }
}

impl Drop for Station {
    fn drop(&mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

struct Client(TcpStream);

impl Client {
    fn connect(address: SocketAddr) -> Self {
        let stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(TIME_LIMIT)).unwrap();
        Self(stream)
    }

    /// Connects as soon as the coupler has a connection left.
    fn served(address: SocketAddr) -> Self {
        let begun = Instant::now();
        loop {
            let mut client = Self::connect(address);
            if client.ask(&[4, 0, 3, 0, 1]).is_some() {
                return client;
            }
            assert!(begun.elapsed() < TIME_LIMIT, "no connection is left");
            thread::sleep(Duration::from_millis(10));
        }
    }

    /// Sends a request to unit 1 and returns function and data of the answer; `None` if the connection is closed.
    fn ask(&mut self, request: &[u8]) -> Option<Vec<u8>> {
        let length = u16::try_from(request.len() + 1).unwrap().to_be_bytes();
        let frame = [&[0x12, 0x34, 0, 0, length[0], length[1], 1], request].concat();
        self.0.write_all(&frame).ok()?;
        let mut head = [0; 7];
        self.0.read_exact(&mut head).ok()?;
        assert_eq!((&head[..4], head[6]), (&[0x12, 0x34, 0, 0][..], 1));
        let mut data = vec![0; usize::from(u16::from_be_bytes([head[4], head[5]])) - 1];
        self.0.read_exact(&mut data).ok()?;
        Some(data)
    }

    fn read(&mut self, register: u16) -> u16 {
        let [high, low] = register.to_be_bytes();
        let answer = self.ask(&[4, high, low, 0, 1]).expect("an answer");
        assert_eq!(answer[..2], [4, 2], "{answer:?}");
        u16::from_be_bytes([answer[2], answer[3]])
    }

    fn write(&mut self, register: u16, value: u16) -> Vec<u8> {
        let ([a, b], [c, d]) = (register.to_be_bytes(), value.to_be_bytes());
        self.ask(&[16, a, b, 0, 1, 2, c, d]).expect("an answer")
    }

    /// Writes the outputs until the vise has these inputs.
    fn drive(&mut self, outputs: u16, vise: u16) {
        let begun = Instant::now();
        while self.read(3) & (OPENED | PARTIAL | CLAMPED) != vise {
            assert_eq!(self.write(OUTPUTS, outputs), [16, 8, 0, 0, 1]);
            assert!(begun.elapsed() < TIME_LIMIT, "{outputs:#x}");
            thread::sleep(Duration::from_millis(20));
        }
    }
}

#[test]
fn vise_and_tray_answer_to_outputs_and_a_person() {
    let mut station = Station::start();
    let mut client = Client::connect(station.fixture);
    assert_eq!((client.read(3) & 0x7, client.read(4) & TRAY), (OPENED, 0));
    client.drive(VISE_PARTIAL, PARTIAL);
    client.drive(VISE_CLOSE, CLAMPED);
    station.enter("tray UNIT_1 4 LINKBAR1_BH");
    let begun = Instant::now();
    while client.read(4) & TRAY == 0 {
        assert!(begun.elapsed() < TIME_LIMIT);
        thread::sleep(Duration::from_millis(20));
    }
    station.enter("tray UNIT_1 9 LINKBAR1_BH");
    assert!(station.wait_for("error: ").contains('9'));
    station.enter("status");
    station.wait_for("[status] outputs on: ");
    station.wait_for("[status] LINKBAR1_BH in UNIT_1 4");
    station.enter("quit");
    while !station.wait_for("[station] ").contains("steps of 20 ms") {}
    assert!(station.child.wait().unwrap().success());
}

/// A WAGO: outputs at 0x200, a watchdog that a register starts, and exception 4 to everything once it has fired.
#[test]
fn coupler_of_another_kind_answers_as_its_manual_says() {
    let wago = |text: String| text.replace("\"bk9000\"", "\"wago\"").replace("holding 0x8", "holding 0x2");
    let station = Station::start_with(&[], wago);
    let mut client = Client::connect(station.fixture);
    assert_eq!(client.write(0x1000, 20), [16, 0x10, 0, 0, 1]);
    assert_eq!(client.write(0x1001, 0x8000), [16, 0x10, 1, 0, 1], "only function 16 restarts it");
    assert_eq!(client.write(0x1003, 1), [16, 0x10, 3, 0, 1]);
    assert_eq!(client.write(0x200, VISE_PARTIAL), [16, 2, 0, 0, 1]);
    station.wait_for("[station] fixture: its watchdog has fired");
    assert_eq!(client.ask(&[3, 2, 0, 0, 1]).unwrap(), [0x83, 4]);
    assert_eq!(client.ask(&[6, 0x10, 8, 0xAA, 0x55]).unwrap(), [6, 0x10, 8, 0xAA, 0x55]);
    assert_eq!(client.ask(&[3, 2, 0, 0, 1]).unwrap(), [3, 2, 0, 0]);
}

#[test]
fn delayed_inputs_arrive_after_the_delay() {
    let station = Station::start_with(&["--delay", "25"], |text| text);
    let started = Instant::now();
    let mut client = Client::connect(station.fixture);
    while client.read(3) & OPENED == 0 {
        assert!(started.elapsed() < TIME_LIMIT);
        thread::sleep(Duration::from_millis(10));
    }
    // The first image is as old as the first step, which is before the station was ready.
    assert!(started.elapsed() >= Duration::from_millis(500), "a second was asked for");
}

#[test]
fn watchdog_of_a_silent_client_makes_the_outputs_safe() {
    let station = Station::start();
    let mut client = Client::connect(station.fixture);
    client.drive(VISE_PARTIAL, PARTIAL);
    station.wait_for("[station] fixture: its watchdog has fired");
    let answer = client.ask(&[3, 8, 0, 0, 1]).unwrap();
    assert_eq!(answer, [3, 2, 0, 0]);
    assert_eq!(client.write(OUTPUTS, VISE_CLOSE), [0x90, 4], "refused until its reset");
    assert_eq!(client.read(3) & 0x7, PARTIAL, "the vise is bistable");
}

#[test]
fn garbage_and_further_connections_do_not_disturb_a_client() {
    let station = Station::start();
    let mut client = Client::connect(station.fixture);
    client.read(3);
    let mut noise = ChaCha8Rng::seed_from_u64(1);
    for length in [1, 6, 7, 8, 12, 100, 259, 260, 261, 5000] {
        for kind in 0..4 {
            let mut bytes: Vec<u8> = (0..length).map(|_| noise.random()).collect();
            // Each frame has fewer errors than the one before.
            let right = [0, 1, 0, 0, 0, 6, 1];
            let kept = [0, 4, 6, 7][kind].min(length);
            bytes[..kept].copy_from_slice(&right[..kept]);
            let mut other = TcpStream::connect(station.fixture).unwrap();
            other.set_read_timeout(Some(Duration::from_millis(20))).unwrap();
            // The station may close the connection at once.
            let _ = other.write_all(&bytes);
            let _ = other.read(&mut [0; 300]);
            client.read(3);
        }
    }
    for wrong in [
        &[3, 0xF0, 0, 0, 1][..],
        &[4, 0, 0, 0, 126],
        &[99],
        &[16, 8, 0, 0, 2, 2, 0, 0],
        &[6, 0x11, 0x20, 0, 0],
    ] {
        let answer = client.ask(wrong);
        assert!(answer.is_none_or(|answer| answer[0] >= 0x80 || wrong[0] == 6), "{wrong:?}");
        client = Client::served(station.fixture);
    }
    let mut others = [Client::served(station.fixture), Client::served(station.fixture)];
    others.iter_mut().for_each(|other| assert_eq!(other.read(3) & OPENED, OPENED));
    assert_eq!(Client::connect(station.fixture).ask(&[4, 0, 3, 0, 1]), None, "the fourth one is refused");
    client.read(3);
}

#[test]
fn used_address_and_unknown_mapping_are_refused() {
    let first = Station::start();
    let second = Command::new(env!("CARGO_BIN_EXE_rcs-cell"))
        .args(["--data", DATA, "--station"])
        .arg(first._directory.path().join("free.toml"))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&second.stderr);
    assert_eq!(second.status.code(), Some(2), "{said}");
    assert!(
        said.contains("arm: a station cannot listen at TCP") && said.contains("is another station running?")
    );
    let unknown = Command::new(env!("CARGO_BIN_EXE_rcs-cell"))
        .args(["--data", DATA, "--station", "stattion"])
        .output()
        .unwrap();
    assert_eq!(unknown.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&unknown.stderr).contains("station"));
}
