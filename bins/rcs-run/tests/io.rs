//! `rcs-run io-test`, `io-release` and `io-calibrate` with emulated couplers over TCP.

use std::{
    fs,
    io::{Read as _, Write as _},
    net::{Ipv4Addr, SocketAddr},
    path::PathBuf,
    process::{Child, Output, Stdio},
};

use couplers::{Emulated, Kind};
use executive::field::{Lock, Station};
use serde_json::Value;
use tempfile::TempDir;

use crate::common::{command, root};

const ADDRESSES: [&str; 3] = ["127.0.0.1:21502", "127.0.0.1:21503", "127.0.0.1:21504"];
const ARM: usize = 0;
const SUPPLY: u16 = 1 << 7; // `grip.supply` in the first output word of the arm

fn start(arguments: &[&str]) -> Child {
    let pipes = || Stdio::piped();
    command(arguments).stdin(pipes()).stdout(pipes()).stderr(pipes()).spawn().unwrap()
}

/// Three couplers, and the shipped mapping with their addresses.
struct Cell {
    stations: Vec<Station>,
    directory: TempDir,
}

impl Cell {
    fn new() -> Self {
        let local = SocketAddr::from((Ipv4Addr::LOCALHOST, 0));
        let open = |_| Station::open(local, Emulated::new(Kind::Bk9000, 1, 32, 16)).unwrap();
        let stations: Vec<Station> = ADDRESSES.iter().map(open).collect();
        let mut text = fs::read_to_string(root().join("data/field/station.toml")).unwrap();
        for (address, station) in ADDRESSES.iter().zip(&stations) {
            text = text.replace(address, &station.address().to_string());
        }
        // Times are not tested, because the machine may be busy.
        text = text.replace("exchange_ms = 20\ntimeout_ms = 15\n", "");
        text =
            text.replace("watchdog_ms = 500\n", "watchdog_ms = 500\nexchange_ms = 1000\ntimeout_ms = 900\n");
        let directory = tempfile::tempdir().unwrap();
        fs::write(directory.path().join("cell.toml"), text).unwrap();
        Self { stations, directory }
    }

    fn mapping(&self) -> PathBuf {
        self.directory.path().join("cell.toml")
    }

    fn run(&self, words: &[&str], answers: &str) -> Output {
        let path = self.mapping();
        let mut arguments = vec![words[0], path.to_str().unwrap()];
        arguments.extend(&words[1..]);
        let mut child = start(&arguments);
        child.stdin.take().unwrap().write_all(answers.as_bytes()).unwrap();
        child.wait_with_output().unwrap()
    }

    fn output(&self) -> u16 {
        self.stations[ARM].with(|coupler| coupler.outputs()[0])
    }

    fn writes(&self) -> u64 {
        self.stations.iter().map(|station| station.with(|coupler| coupler.writes())).sum()
    }
}

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {output:?}"))
}

#[test]
fn test_of_inputs_gives_every_point_a_verdict_and_writes_no_output() {
    let cell = Cell::new();
    let output = cell.run(&["io-test", "--seconds", "1", "--json"], "");
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let tally = json(&output);
    let devices = tally["devices"].as_array().unwrap();
    assert_eq!(devices.len(), 3);
    for device in devices {
        assert_eq!((&device["verdict"], &device["identity"]), (&"good".into(), &"BK9000emulate".into()));
        assert!(device["exchanges"].as_u64() >= Some(10), "{device}");
    }
    let inputs = tally["inputs"].as_array().unwrap();
    let potentiometer = inputs.iter().find(|input| input["name"] == "grip.potentiometer").unwrap();
    assert_eq!(potentiometer["verdict"], "steady", "a sensor without noise is suspicious");
    assert!(inputs.iter().any(|input| input["name"] == "vise.PFIXTURE.opened"), "points of the workstation");
    assert_eq!(cell.writes(), 0);
}

#[test]
fn absent_coupler_is_named_and_fails_the_test() {
    let mut cell = Cell::new();
    let address = cell.stations.remove(ARM).address();
    let output = cell.run(&["io-test", "--seconds", "1", "--json"], "");
    assert_eq!(output.status.code(), Some(1), "{output:?}");
    let arm = &json(&output)["devices"][ARM];
    assert_eq!(arm["verdict"], "not-ready");
    let expected = format!("arm at {address}: it does not accept a connection");
    assert_eq!(arm["hindrance"], expected.as_str());
}

#[test]
fn outputs_are_written_only_after_a_yes() {
    let cell = Cell::new();
    let output = cell.run(&["io-test", "--seconds", "1", "--outputs"], "n\n");
    assert_eq!((output.status.code(), cell.writes()), (Some(2), 0), "{output:?}");
    let output = cell.run(&["io-test", "--seconds", "1", "--outputs", "--watchdog", "--json"], "y\ny\ny\n");
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let tally = json(&output);
    let verdicts: Vec<_> = tally["outputs"].as_array().unwrap().iter().map(|one| &one["verdict"]).collect();
    assert_eq!(verdicts[0], "good");
    assert!(verdicts[1..].iter().all(|verdict| *verdict == "skipped"), "{verdicts:?}");
    let fallback = tally["devices"][ARM]["fallback_ms"].as_u64().unwrap();
    assert!(fallback >= 400, "the watchdog is set to 500 ms, found {fallback} ms");
    assert_eq!(cell.output(), 0);
}

#[test]
fn outputs_of_an_earlier_controller_are_released_after_a_yes() {
    let cell = Cell::new();
    cell.stations[ARM].with(|coupler| coupler.outputs_mut()[0] = SUPPLY);
    let output = cell.run(&["io-release"], "n\n");
    assert_eq!((output.status.code(), cell.output()), (Some(1), SUPPLY), "{output:?}");
    let output = cell.run(&["io-release"], "y\n");
    assert_eq!((output.status.code(), cell.output()), (Some(0), 0), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("arm: safe, and confirmed"), "{text}");
    assert!(text.contains("fixture: no output is on"), "{text}");
    let questions = String::from_utf8(output.stderr).unwrap();
    assert!(questions.contains("arm: grip.supply on"), "{questions}");
}

#[test]
fn devices_of_another_process_are_refused() {
    let cell = Cell::new();
    let _lock = Lock::take(cell.stations[ARM].address(), 1).unwrap();
    let output = cell.run(&["io-test", "--seconds", "1"], "");
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(text.contains("arm: another process of this machine controls the device"), "{text}");
}

#[test]
fn calibration_prints_the_line_between_two_states() {
    let cell = Cell::new();
    let sense = |raw: u16| cell.stations[ARM].with(|coupler| coupler.inputs_mut()[0] = raw);
    let path = cell.mapping();
    let arguments = ["io-calibrate", path.to_str().unwrap(), "grip.potentiometer", "--counts", "205", "2305"];
    let mut child = start(&arguments);
    let (mut answers, mut questions) = (child.stdin.take().unwrap(), child.stderr.take().unwrap());
    let mut asked = Vec::new();
    for (raw, counts) in [(1000, "205"), (30_000, "2305")] {
        while !String::from_utf8_lossy(&asked).contains(&format!("to {counts} counts")) {
            let mut byte = [0];
            assert_eq!(questions.read(&mut byte).unwrap(), 1, "{}", String::from_utf8_lossy(&asked));
            asked.push(byte[0]);
        }
        sense(raw);
        answers.write_all(b"\n").unwrap();
    }
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(text, "\"grip.potentiometer\": raw = [1000, 30000], counts = [205, 2305]\n");
    let output = cell.run(&["io-calibrate", "grip.supply"], "");
    assert_eq!(output.status.code(), Some(2), "an output has no line");
}

#[test]
fn gripper_that_loses_its_part_without_exchanges_is_named() {
    let hold = |moves: u16| {
        let cell = Cell::new();
        let path = cell.mapping();
        let mut child = start(&[
            "io-test",
            path.to_str().unwrap(),
            "--seconds",
            "1",
            "--points",
            "grip.",
            "--hold",
            "grip",
            "--json",
        ]);
        child.stdin.take().unwrap().write_all(b"y\ny\n").unwrap();
        let arm = &cell.stations[ARM];
        // The fingers stop at the part, and move when the watchdog has switched the outputs off.
        arm.with(|coupler| coupler.inputs_mut()[0] = 8000);
        while child.try_wait().unwrap().is_none() && arm.with(|coupler| coupler.fallbacks()) == 0 {
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        arm.with(|coupler| coupler.inputs_mut()[0] += moves);
        let output = child.wait_with_output().unwrap();
        (output.status.code(), json(&output)["hold"].clone(), cell.output())
    };
    std::thread::scope(|scope| {
        let [keeps, loses] = [0, 400].map(|moves| scope.spawn(move || hold(moves)));
        let (status, tally, outputs) = keeps.join().unwrap();
        assert_eq!((status, &tally["verdict"], outputs), (Some(0), &"good".into(), 0), "{tally}");
        let (status, tally, outputs) = loses.join().unwrap();
        assert_eq!((status, &tally["verdict"], outputs), (Some(1), &"not-held".into(), 0), "{tally}");
        assert_eq!(tally["note"], "grip.potentiometer has changed by 50 counts");
    });
}

#[test]
fn ring_with_a_gripper_is_unlocked_only_in_its_holster() {
    let cell = Cell::new();
    let sense = |index: usize, register: usize, word: u16| {
        cell.stations[index].with(|coupler| coupler.inputs_mut()[register] = word);
    };
    let test = |cell: &Cell| {
        let words = ["io-test", "--seconds", "1", "--points", "quick-change.unlock", "--outputs", "--json"];
        let output = cell.run(&words, "y\ny\ny\n");
        (output.status.code(), json(&output)["outputs"][0].clone())
    };
    sense(ARM, 8, 1 << 10);
    sense(1, 2, 0x0CCC & !(1 << 6));
    let (status, entry) = test(&cell);
    assert_eq!((status, &entry["verdict"]), (Some(1), &"refused".into()), "{entry}");
    assert!(entry["note"].as_str().unwrap().starts_with("holster.left.small-1 is 0"), "{entry}");
    sense(1, 2, 0x0CCC);
    let (status, entry) = test(&cell);
    assert_eq!((status, &entry["verdict"]), (Some(0), &"good".into()), "{entry}");
}

#[test]
fn outputs_that_may_hold_something_refuse_the_test_of_outputs() {
    const TOOL_CLOSE: u16 = 1 << 11;
    let cell = Cell::new();
    cell.stations[ARM].with(|coupler| coupler.outputs_mut()[0] = TOOL_CLOSE);
    let output = cell.run(&["io-test", "--seconds", "1", "--outputs"], "y\n");
    assert_eq!((output.status.code(), cell.output()), (Some(2), TOOL_CLOSE), "{output:?}");
    let text = String::from_utf8(output.stderr).unwrap();
    assert!(text.contains("tool.close on, and may hold something"), "{text}");
}
