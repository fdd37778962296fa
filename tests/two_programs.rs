//! A controller and a cell in two programs, connected by Modbus TCP, EGM and the mailboxes of vision.

use std::{
    fs,
    io::{BufRead as _, BufReader, Write as _},
    net::{TcpListener, UdpSocket},
    process::{Child, Command, Stdio},
    sync::mpsc,
    thread,
    time::Duration,
};

use serde_json::Value;
use whole_system_tests::{rcs_cell, rcs_run, root};

const TIME_LIMIT: Duration = Duration::from_secs(60);
/// A person fills a tray, the vise moves, and the robot moves to HOME.
const JOB: &str = "** tray UNIT_1 4 LINKBAR1_BH\n\
                   ** vise partial PFIXTURE\n\
                   == MOVE -- +0 -- 0 +0 HOME 0 -- 0\n\
                   ** vise open PFIXTURE\n";

struct Cell(Child); // ends the cell with the test

impl Drop for Cell {
    fn drop(&mut self) {
        self.0.kill().expect("it can be ended");
        self.0.wait().expect("it has ended");
    }
}

#[test]
fn job_is_finished_by_two_programs_with_nothing_simulated() {
    let directory = tempfile::tempdir().expect("a directory");
    let [job, mapping, socket] =
        ["short.job", "free.toml", "rcs.sock"].map(|name| directory.path().join(name));
    fs::write(&job, JOB).expect("a job");
    let mut text = fs::read_to_string(root().join("data/field/station.toml")).expect("the mapping");
    let free = [21502, 21503, 21504].map(|_| TcpListener::bind("127.0.0.1:0").expect("a free port"));
    for (shipped, free) in [21502, 21503, 21504].into_iter().zip(&free) {
        let address = free.local_addr().expect("an address").to_string();
        text = text.replace(&format!("127.0.0.1:{shipped}"), &address);
    }
    drop(free);
    fs::write(&mapping, text).expect("a mapping");
    let robot = UdpSocket::bind("127.0.0.1:0").and_then(|socket| socket.local_addr()).expect("a free port");
    let network = format!("unix:{}", socket.display());
    let mut cell = Command::new(rcs_cell())
        .current_dir(root())
        .args(["--egm-robot", &robot.port().to_string(), "--vision", &network, "--station"])
        .arg(&mapping)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .map(Cell)
        .expect("rcs-cell can be started");
    let (lines, screen) = mpsc::channel();
    let output = BufReader::new(cell.0.stdout.take().expect("piped"));
    thread::spawn(move || output.lines().map_while(Result::ok).try_for_each(|line| lines.send(line)));
    let first = screen.recv_timeout(TIME_LIMIT).expect("the cell is ready");
    let is_ready = |line: &str| line.starts_with("[station] ready");
    assert!(is_ready(&first) || screen.iter().any(|line| is_ready(&line)), "{first}");
    let mut console = cell.0.stdin.take().expect("piped");
    writeln!(console, "tray UNIT_1 4 LINKBAR1_BH").expect("the cell reads lines");
    let output = Command::new(rcs_run())
        .current_dir(root())
        .args(["--json", "--shared-memory", "off", "--log", "none", "--clock", "real", "--outside", "vision"])
        .args(["--network", &network, "--robot", &format!("egm:{}", robot.port()), "--field"])
        .args([&mapping, &job])
        .output()
        .expect("rcs-run can be started");
    let said = String::from_utf8_lossy(&output.stderr);
    let result: Value =
        serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {said}"));
    assert_eq!(output.status.code(), Some(0), "{}: {said}", result["failure"]);
    assert_eq!(result["field"]["simulated"], serde_json::json!([]), "{}", result["field"]);
    assert_eq!(result["allocations_after_start"], 0);
}
