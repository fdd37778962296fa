//! An operator is a role of the network like others: its certificate lets it in, and nothing else.

use std::{
    fs,
    io::{Read as _, Write as _},
    net::{Shutdown, TcpStream},
    os::unix::net::{UnixListener, UnixStream},
    path::{Path, PathBuf},
    process::Command,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use executive::memory::{RunName, operator_socket};
use record::Log;
use sessions::network::{Address, NeighbourKeys, Peer, PeerError, Role};
use sessions::operator::{Client, ClientError};
use whole_system_tests::{Scratch, rcs_run, root};

use super::bench::{Controller, PATIENCE, make_keys};

const JOB: &str = "== MOVE -- 0 -- 0 0 SAFE 0 -- 0\n";

/// A run at a port, on stand-by if an operator may connect, with its keys and its log.
struct Cell {
    controller: Controller,
    keys: PathBuf,
    log: PathBuf,
    name: RunName,
}

impl Cell {
    fn start(name: &str, outside: &str, access: &str) -> Self {
        let scratch = Scratch::new(name);
        let keys = make_keys(&scratch, "keys", 1);
        let (log, job) = (scratch.file("log.mcap"), scratch.file("safe.job"));
        fs::write(&job, JOB).expect("a job can be written");
        let name: RunName = format!("{name}-{}", std::process::id()).parse().expect("a name");
        let paths = [&keys, &log, &job].map(|path| path.display().to_string());
        let [keys_text, log_text, job_text] = paths.each_ref().map(String::as_str);
        let more = [
            &["--clock", "5x", "--operator", access, "--keys", keys_text][..],
            // Without an operator nobody ends a stand-by.
            if access == "none" { &[] } else { &["--stand-by"] },
            &["--run", name.as_str(), "--log", log_text, job_text],
        ];
        let controller = Controller::start_at(scratch, Some("tcp:127.0.0.1:0"), outside, &more.concat());
        Self { controller, keys, log, name }
    }

    /// Ask for admission as soon as the run lets operators in.
    fn admission(&self, keys: &Path) -> Result<Peer, PeerError> {
        let keys = NeighbourKeys::load(keys, Role::Operator).expect("they can be used");
        let begun = Instant::now();
        loop {
            match Peer::connect_within(PATIENCE, &self.controller.address, Role::Operator, Some(&keys)) {
                Err(PeerError::Disconnected(why)) if why.starts_with("the run has not begun") => {
                    assert!(begun.elapsed() < PATIENCE, "{why}");
                    thread::sleep(Duration::from_millis(50));
                }
                other => return other,
            }
        }
    }

    /// `rcs-run send` over the network: whether it was taken, and what it prints.
    fn send(&self, line: &str) -> (bool, String) {
        let address = self.controller.address.to_string();
        let output = Command::new(rcs_run())
            .args(["send", "--connect", &address, "--name", "anna", line, "--keys"])
            .arg(&self.keys)
            .current_dir(root())
            .output()
            .expect("rcs-run can be started");
        let said = [output.stdout, output.stderr].concat();
        (output.status.success(), String::from_utf8_lossy(&said).into_owned())
    }
}

fn refused(result: Result<Peer, PeerError>) -> String {
    result.err().expect("it is refused").to_string()
}

#[test]
fn an_operator_with_its_certificate_works_on_a_run_and_one_without_does_not() {
    let cell = Cell::start("net-operator", "", "network");
    let (stream, carrier) =
        cell.admission(&cell.keys).expect("it is admitted").into_stream().expect("a pair");
    let mut anna = Client::over(stream, carrier, &"anna".parse().expect("a name")).expect("a session");
    assert_eq!(anna.run(), cell.name.as_str());
    assert!(anna.ask("joystick velocity 900").expect("an answer").is_ok());
    // The certificate of another role, and no TLS at all.
    let wrong = cell.controller.file("wrong");
    fs::create_dir(&wrong).expect("a directory can be made");
    for (from, to) in [("ca.pem", "ca.pem"), ("vision.pem", "operator.pem"), ("vision.key", "operator.key")] {
        fs::copy(cell.keys.join(from), wrong.join(to)).expect("it can be copied");
    }
    let why = refused(cell.admission(&wrong));
    assert!(why.contains("the certificate is bound to vision, not to operator"), "{why}");
    let Address::Tcp(port) = cell.controller.address else { panic!("a port was asked for") };
    let mut plain = TcpStream::connect(port).expect("it waits");
    plain.write_all(b"RCS2\x03\x00\x05\x00").expect("it reads");
    let mut answer = Vec::new();
    plain.read_to_end(&mut answer).expect("it closes");
    assert_eq!(answer.first(), Some(&21), "a TLS alert, and nothing of the protocol: {answer:02X?}");
    // One commands, here and there, whatever name the other one gives.
    let mut local =
        Client::connect(&operator_socket(&cell.name), &"anna".parse().expect("a name")).expect("it waits");
    let why = local.ask("joystick velocity 800").expect("an answer").expect_err("another one commands");
    assert!(why.starts_with("net1.anna commands this run"), "{why}");
    assert!(local.ask("stop").expect("an answer").is_ok(), "a stop is for everybody");
    let (taken, said) = cell.send("joystick velocity 700");
    assert!(!taken && said.contains("net1.anna commands this run"), "{said}");
    drop(local);
    for line in ["go", "job go"] {
        assert!(anna.ask(line).expect("an answer").is_ok(), "{line}");
    }
    let Cell { controller, log, .. } = cell;
    let mut lines = Vec::new();
    let ended = controller.end_with(|| lines.extend(Log::open(&log).expect("a log").operator_lines()));
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    for event in ["operator has connected", "a connection was refused: the certificate is bound to vision"] {
        assert!(ended.page.contains(event), "{event}: {}", ended.page);
    }
    let said = |source: &str, line: &str| {
        let found = lines.iter().find(|one| one.source == source && one.line == line);
        found.map(|one| one.refused.is_some())
    };
    assert_eq!(said("net1.anna", "job go"), Some(false));
    assert_eq!(said("anna", "joystick velocity 800"), Some(true));
    assert_eq!(said("net2.anna", "joystick velocity 700"), Some(true));
}

/// A connection to a run that can stall: bytes to the run then wait, as on a network whose packets are lost.
struct Line {
    address: Address,
    stalls: Arc<AtomicBool>,
}

impl Line {
    fn to(controller: &Controller) -> Self {
        let Address::Unix(run) = controller.address.clone() else { panic!("a socket was asked for") };
        let path = controller.file("line.sock");
        let listener = UnixListener::bind(&path).expect("a socket");
        let stalls = Arc::new(AtomicBool::new(false));
        let stalling = Arc::clone(&stalls);
        thread::spawn(move || {
            for near in listener.incoming() {
                let near = near.expect("one connects");
                let far = UnixStream::connect(&run).expect("the run listens");
                let [near_again, far_again] = [&near, &far].map(|end| end.try_clone().expect("a stream"));
                let stalling = Arc::clone(&stalling);
                thread::spawn(move || carry(far_again, near_again, &AtomicBool::new(false)));
                thread::spawn(move || carry(near, far, &stalling));
            }
        });
        Self { address: format!("unix:{}", path.display()).parse().expect("an address"), stalls }
    }
}

fn carry(mut from: UnixStream, mut to: UnixStream, stalls: &AtomicBool) {
    let mut bytes = [0; 4096];
    while let Ok(count @ 1..) = from.read(&mut bytes) {
        while stalls.load(Ordering::Relaxed) {
            thread::sleep(Duration::from_millis(5));
        }
        if to.write_all(&bytes[..count]).is_err() {
            break;
        }
    }
    // The other end may have closed already.
    let _ = to.shutdown(Shutdown::Both);
}

/// The run cannot know from its own clock how long a request was on its way; its limit tells it.
#[test]
fn a_command_that_a_stalled_line_delays_is_discarded() {
    let scratch = Scratch::new("stalled");
    let (log, job) = (scratch.file("log.mcap"), scratch.file("safe.job"));
    fs::write(&job, JOB).expect("a job can be written");
    let [log_text, job_text] = [&log, &job].map(|path| path.display().to_string());
    let more = ["--clock", "5x", "--stand-by", "--operator", "network", "--run", "stalled-line"];
    let controller =
        Controller::start_at(scratch, None, "", &[&more[..], &["--log", &log_text, &job_text]].concat());
    let line = Line::to(&controller);
    let begun = Instant::now();
    let peer = loop {
        match Peer::connect_within(PATIENCE, &line.address, Role::Operator, None) {
            Ok(peer) => break peer,
            Err(why) => assert!(begun.elapsed() < PATIENCE, "{why}"),
        }
        thread::sleep(Duration::from_millis(50));
    };
    let (stream, carrier) = peer.into_stream().expect("a pair");
    let mut anna = Client::over(stream, carrier, &"anna".parse().expect("a name")).expect("a session");
    assert!(anna.ask("joystick velocity 900").expect("an answer").is_ok());
    line.stalls.store(true, Ordering::Relaxed);
    let given_up = anna.ask("MOVE -- 0 -- 0 0 HOME 0 -- 0");
    assert!(matches!(given_up, Err(ClientError::Silent)), "{given_up:?}");
    thread::sleep(Duration::from_millis(1500));
    line.stalls.store(false, Ordering::Relaxed);
    for request in ["joystick velocity 1000", "job go"] {
        assert!(anna.ask(request).expect("an answer").is_ok(), "{request}");
    }
    let mut lines = Vec::new();
    let ended = controller.end_with(|| lines.extend(Log::open(&log).expect("a log").operator_lines()));
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    let found = lines.iter().find(|line| line.line.contains("MOVE")).expect("it arrived");
    assert!(found.line.starts_with("(given up) ") && found.refused.is_some(), "{found:?}");
}

#[test]
fn a_run_says_who_may_operate_it() {
    for access in ["none", "owner"] {
        let cell = Cell::start(&format!("net-{access}"), "workstation", access);
        let why = refused(cell.admission(&cell.keys));
        assert!(why.contains("the run takes no operator over the network"), "{access}: {why}");
        // The certificate of an operator is no other's.
        for extension in ["pem", "key"] {
            let of = |name: &str| cell.keys.join(name).with_extension(extension);
            fs::copy(of("operator"), of("workstation")).expect("it can be copied");
        }
        let why = refused(cell.controller.try_connect(Role::Workstation, Some(&cell.keys)));
        assert!(why.contains("the certificate is bound to operator, not to workstation"), "{access}: {why}");
    }
}

#[test]
fn options_that_let_nobody_in_are_refused() {
    let start = |arguments: &[&str]| {
        let output = Command::new(rcs_run()).args(arguments).current_dir(root()).output();
        let output = output.expect("rcs-run can be started");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).trim_end().to_owned())
    };
    let socket = format!("unix:{}", Scratch::new("nobody").file("rcs.sock").display());
    for (arguments, why) in [
        (&["--network", &socket][..], "nobody may connect at the address of --network"),
        (&["--network", &socket, "--outside", "operator"], "an operator is no neighbour"),
        (&["--network", &socket, "--operator", "network"], "--operator network needs --clock real"),
        (&["--clock", "real", "--operator", "network"], "--operator network needs --clock real"),
    ] {
        let (status, said) = start(arguments);
        assert_eq!(status, Some(2), "{arguments:?}: {said}");
        assert!(said.contains(why), "{arguments:?}: {said}");
    }
}
