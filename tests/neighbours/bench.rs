//! A controller with external neighbours, and a workstation controller under control of the test.

use std::{
    io::{BufRead as _, BufReader, Read as _},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use interfaces::{CommonMemory, Header, HwsCommand};
use neighbours::{
    mailbox::{CELL_COMMAND, CELL_STATUS, HWSC_COMMAND, HWSC_STATUS, Mailbox},
    workstation::{
        Status,
        cell::{self, CellStatus},
        command, status,
    },
};
use rcs_core::{Plain as _, digest::Digest, name::Name16, plain::from_bytes};
use record::Log;
use serde_json::Value;
use sessions::network::{Address, Peer, PeerError, Received, Role};
use whole_system_tests::{Scratch, rcs_run, root};

pub const TIME_LIMIT: Duration = Duration::from_secs(120); // for actions that take milliseconds

pub struct Controller {
    pub child: Child,
    pub address: Address,
    pub scratch: Option<Scratch>,
    said: Option<JoinHandle<String>>,
}

pub struct Ended {
    pub status: Option<i32>,
    pub result: Value,
    pub page: String,
    pub said: String,
}

impl Controller {
    pub fn start(name: &str, outside: &str, more: &[&str]) -> Self {
        Self::start_at(Scratch::new(name), None, outside, more)
    }

    pub fn start_at(scratch: Scratch, address: Option<&str>, outside: &str, more: &[&str]) -> Self {
        let socket = format!("unix:{}", scratch.file("rcs.sock").display());
        let mut child = Command::new(rcs_run())
            .args(["--network", address.unwrap_or(&socket)])
            .args((!outside.is_empty()).then(|| format!("--outside={outside}")))
            // An operator can connect only to a run with a name.
            .args(if more.contains(&"--run") { &[][..] } else { &["--shared-memory", "off"] })
            .args(if more.contains(&"--log") { &[][..] } else { &["--log", "none"] })
            .args(more)
            .current_dir(root())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("rcs-run can be started");
        let mut stderr = BufReader::new(child.stderr.take().expect("it is piped"));
        let mut said = String::new();
        let address = loop {
            let mut line = String::new();
            assert!(stderr.read_line(&mut line).expect("text") > 0, "rcs-run ended at once: {said}");
            said.push_str(&line);
            if let Some((_, address)) = line.trim_end().split_once("can connect at ") {
                break address.parse().expect("an address");
            }
        };
        let said = thread::spawn(move || {
            stderr.read_to_string(&mut said).expect("text");
            said
        });
        Self { child, address, scratch: Some(scratch), said: Some(said) }
    }

    pub fn file(&self, name: &str) -> PathBuf {
        self.scratch.as_ref().expect("it has one").file(name)
    }

    pub fn connect(&self, role: Role) -> Peer {
        let started = Instant::now();
        loop {
            match self.try_connect(role) {
                Err(PeerError::Disconnected(why)) if why.ends_with("is connected already") => {
                    assert!(started.elapsed() < TIME_LIMIT, "{why}");
                    thread::sleep(Duration::from_millis(10));
                }
                peer => return peer.expect("it waits"),
            }
        }
    }

    pub fn try_connect(&self, role: Role) -> Result<Peer, PeerError> {
        Peer::connect_within(TIME_LIMIT, &self.address, role)
    }

    pub fn kill(mut self) -> Scratch {
        self.child.kill().expect("it runs");
        self.child.wait().expect("a child");
        self.scratch.take().expect("it has one")
    }

    pub fn end(self) -> Ended {
        self.end_with(|| {})
    }

    pub fn end_with(mut self, look: impl FnOnce()) -> Ended {
        let mut page = String::new();
        self.child.stdout.take().expect("it is piped").read_to_string(&mut page).expect("text");
        let status = self.child.wait().expect("a child").code();
        let said = self.said.take().expect("once").join().expect("it reads");
        look();
        Ended { status, result: serde_json::from_str(&page).unwrap_or(Value::Null), page, said }
    }
}

impl Drop for Controller {
    fn drop(&mut self) {
        let _ = self.child.kill(); // it has already ended if the test succeeded
        let _ = self.child.wait();
    }
}

pub struct Workstation {
    pub peer: Peer,
    pub tick: u64,
    unanswered: bool, // messages before the answer belong to the tick of the pulse
    command_box: Mailbox,
    cell_box: Mailbox,
    line: u16,
}

impl Workstation {
    pub fn connect(controller: &Controller) -> Self {
        let peer = controller.connect(Role::Workstation);
        let command_box = Mailbox::initialized(HWSC_COMMAND);
        let cell_box = Mailbox::initialized(CELL_COMMAND);
        let mut workstation = Self { peer, tick: 0, unanswered: false, command_box, cell_box, line: 0 };
        // The controller's state is unknown before its first status.
        while workstation.peer.mailbox(HWSC_STATUS).mailgram() == 0 {
            workstation.tick();
        }
        workstation
    }

    pub fn tick(&mut self) {
        self.read_tick().expect("the controller continues");
    }

    fn read_tick(&mut self) -> Result<(), PeerError> {
        if self.unanswered {
            self.peer.pulse(self.tick)?;
        }
        loop {
            if let Received::Pulse(tick) = self.peer.receive()? {
                (self.tick, self.unanswered) = (tick, true);
                return Ok(());
            }
        }
    }

    pub fn run_to(&mut self, tick: u64) {
        while self.tick < tick {
            self.tick();
        }
    }

    pub fn write(&mut self, data: &[u8]) {
        self.command_box.write(data).expect("it fits");
        self.peer.send(&self.command_box).expect("the controller reads");
    }

    pub fn send(&mut self, command: &HwsCommand) {
        self.write(&command::encode(command).expect("it fits"));
    }

    pub fn in_cell(&mut self, line: &str) {
        self.begin_in_cell(line);
        loop {
            self.tick();
            assert_eq!(self.cell().text, "", "{line}");
            if self.cell_is_idle() {
                return;
            }
        }
    }

    pub fn begin_in_cell(&mut self, line: &str) {
        self.line += 1;
        self.write_cell(&cell::encode_line(self.line, line));
    }

    pub fn cell_is_idle(&self) -> bool {
        self.cell().echo == self.line && !self.cell().busy
    }

    pub fn write_cell(&mut self, data: &[u8]) {
        self.cell_box.write(data).expect("it fits");
        self.peer.send(&self.cell_box).expect("the controller reads");
    }

    pub fn cell(&self) -> CellStatus<'_> {
        CellStatus::decode(self.peer.mailbox(CELL_STATUS).data()).expect("a status")
    }

    pub fn status(&self) -> Status<'_> {
        status::decode(self.peer.mailbox(HWSC_STATUS).data()).expect("a status")
    }

    pub fn carry_out(&mut self, command: &HwsCommand) -> (String, String) {
        self.send(command);
        loop {
            self.tick();
            let status = self.status();
            let mine = u32::from(status.echo) == command.number;
            if mine && !matches!(status.report.text(), "executing" | "idle") {
                return (status.report.text().to_owned(), status.reason.to_owned());
            }
            assert_eq!(status.verdict, 0, "{}", status.reason);
        }
    }
}

/// Answers every pulse until the connection ends.
pub fn attend(mut peer: Peer) {
    while let Ok(received) = peer.receive() {
        if let Received::Pulse(tick) = received
            && peer.pulse(tick).is_err()
        {
            return;
        }
    }
}

pub fn bare(number: u32, verb: &str) -> HwsCommand {
    HwsCommand { number, command: Name16::clipped(verb), ..HwsCommand::default() }
}

pub fn example(name: &str) -> PathBuf {
    root().join("examples").join(name)
}

/// Digest of all buffers in all ticks, without the table values of the pedestal, which its mailboxes omit.
pub fn computed(log: &Path) -> u64 {
    let log = Log::open(log).expect("a log");
    let (mut digest, mut scratch) = (Digest::new(), vec![0; CommonMemory::SIZE]);
    for logged in log.ticks() {
        let image = logged.expect("a whole log").memory;
        let mut memory: CommonMemory = from_bytes(&image).expect("a picture of the buffers");
        let CommonMemory { pedestal, hand, table, .. } = &mut memory;
        for header in [&mut pedestal.header, &mut hand.header, &mut table.header] {
            *header = Header { basis: None, beside: Default::default(), ..*header };
        }
        digest.add_record(&memory, &mut scratch);
    }
    digest.value()
}

/// [`computed`] of a shipped job, with all neighbours in the controller's process.
pub fn computed_alone(job: &str, options: &[&str]) -> u64 {
    let scratch = Scratch::new(&format!("alone-{job}"));
    let log = scratch.file("alone.mcap");
    let run = Command::new(rcs_run())
        .args([job, "--shared-memory", "off", "--log"])
        .arg(&log)
        .args(options)
        .current_dir(root())
        .output()
        .expect("rcs-run can be started");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    computed(&log)
}

pub fn run_alone(arguments: &[&str]) -> Value {
    let output = Command::new(rcs_run())
        .args(arguments)
        .args(["--json", "--log", "none", "--shared-memory", "off"])
        .current_dir(root())
        .output()
        .expect("rcs-run can be started");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("a result")
}
