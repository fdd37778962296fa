//! An operator connects over the network, if the run admits operators there.

use std::{
    fs,
    io::{Read as _, Write as _},
    net::Shutdown,
    os::unix::net::{UnixListener, UnixStream},
    path::PathBuf,
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
use sessions::network::{Address, PeerError, connect_operator};
use sessions::operator::{Client, ClientError};
use whole_system_tests::{Scratch, rcs_run, root};

use super::bench::{Controller, TIME_LIMIT};

const JOB: &str = "== MOVE -- 0 -- 0 0 SAFE 0 -- 0\n";

struct Cell {
    controller: Controller,
    log: PathBuf,
    name: RunName,
}

impl Cell {
    fn start(name: &str, outside: &str, access: &str) -> Self {
        let scratch = Scratch::new(name);
        let (log, job) = (scratch.file("log.mcap"), scratch.file("safe.job"));
        fs::write(&job, JOB).expect("a job can be written");
        let name: RunName = format!("{name}-{}", std::process::id()).parse().expect("a name");
        let paths = [&log, &job].map(|path| path.display().to_string());
        let [log_text, job_text] = paths.each_ref().map(String::as_str);
        let more = [
            &["--clock", "5x", "--operator", access][..],
            // A stand-by would not end without an operator.
            if access == "none" { &[] } else { &["--stand-by"] },
            &["--run", name.as_str(), "--log", log_text, job_text],
        ];
        let controller = Controller::start_at(scratch, None, outside, &more.concat());
        Self { controller, log, name }
    }

    fn admission(&self) -> Result<UnixStream, PeerError> {
        admission(&self.controller.address)
    }

    fn send(&self, line: &str) -> (bool, String) {
        let address = self.controller.address.to_string();
        let output = Command::new(rcs_run())
            .args(["send", "--connect", &address, "--name", "anna", line])
            .current_dir(root())
            .output()
            .expect("rcs-run can be started");
        let said = [output.stdout, output.stderr].concat();
        (output.status.success(), String::from_utf8_lossy(&said).into_owned())
    }
}

fn admission(address: &Address) -> Result<UnixStream, PeerError> {
    let begun = Instant::now();
    loop {
        match connect_operator(address) {
            Err(PeerError::Disconnected(why)) if why.starts_with("the run has not begun") => {
                assert!(begun.elapsed() < TIME_LIMIT, "{why}");
                thread::sleep(Duration::from_millis(200));
            }
            other => return other,
        }
    }
}

#[test]
fn operator_of_the_network_commands_and_another_name_does_not_hide_it() {
    let cell = Cell::start("net-operator", "", "network");
    let stream = cell.admission().expect("it is admitted");
    let mut anna = Client::over(stream, &"anna".parse().expect("a name")).expect("a session");
    assert_eq!(anna.run(), cell.name.as_str());
    assert!(anna.ask("joystick velocity 900").expect("an answer").is_ok());
    // Only one operator can command, local or remote, under any name.
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
    let said = |source: &str, line: &str| {
        let found = lines.iter().find(|one| one.source == source && one.line == line);
        found.map(|one| one.refused.is_some())
    };
    assert_eq!(said("net1.anna", "job go"), Some(false));
    assert_eq!(said("anna", "joystick velocity 800"), Some(true));
    assert_eq!(said("net2.anna", "joystick velocity 700"), Some(true));
}

/// A connection that can stall, as on a lossy network.
struct Line {
    address: Address,
    stalls: Arc<AtomicBool>,
}

impl Line {
    fn to(controller: &Controller) -> Self {
        let run = controller.address.path().to_owned();
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
    let _ = to.shutdown(Shutdown::Both); // the other end may have closed already
}

/// The run cannot measure with its own clock how long a request was delayed. So each request carries a time limit.
#[test]
fn command_delayed_by_a_stalled_line_is_discarded() {
    let scratch = Scratch::new("stalled");
    let (log, job) = (scratch.file("log.mcap"), scratch.file("safe.job"));
    fs::write(&job, JOB).expect("a job can be written");
    let [log_text, job_text] = [&log, &job].map(|path| path.display().to_string());
    let more = ["--clock", "5x", "--stand-by", "--operator", "network", "--run", "stalled-line"];
    let controller =
        Controller::start_at(scratch, None, "", &[&more[..], &["--log", &log_text, &job_text]].concat());
    let line = Line::to(&controller);
    let stream = admission(&line.address).expect("it is admitted");
    let mut anna = Client::over(stream, &"anna".parse().expect("a name")).expect("a session");
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
fn run_reports_its_permitted_operators() {
    for access in ["none", "owner"] {
        let cell = Cell::start(&format!("net-{access}"), "workstation", access);
        let why = cell.admission().expect_err("it is refused").to_string();
        assert!(why.contains("the run takes no operator at its network"), "{access}: {why}");
    }
}

#[test]
fn options_that_exclude_every_operator_are_refused() {
    let start = |arguments: &[&str]| {
        let output = Command::new(rcs_run()).args(arguments).current_dir(root()).output();
        let output = output.expect("rcs-run can be started");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).trim_end().to_owned())
    };
    let socket = format!("unix:{}", Scratch::new("nobody").file("rcs.sock").display());
    for (arguments, why) in [
        (&["--network", &socket][..], "nobody may connect at the address of --network"),
        (&["--network", &socket, "--outside", "operator"], "an operator is not a neighbour"),
        (&["--network", &socket, "--operator", "network"], "--operator network needs --clock real"),
        (&["--clock", "real", "--operator", "network"], "--operator network needs --clock real"),
    ] {
        let (status, said) = start(arguments);
        assert_eq!(status, Some(2), "{arguments:?}: {said}");
        assert!(said.contains(why), "{arguments:?}: {said}");
    }
}
