//! `rcs-log` reads the rest of a damaged log or prints an error, within a gigabyte of memory. The robustness campaign
//! (tests/robustness) damages logs at random places.

use std::{
    fs::{self, File},
    path::{Path, PathBuf},
    process::{Command, Output},
};

use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::Ladder;
use rcs_core::{name::Name16, tick::Tick};
use record::{CellFrame, CellModel, End, Epoch, Log, Pace, Recorder, Setup, Timing};
use taskdata::files::TaskData;

const TICKS: u64 = 260;
const LIMIT: &str = "1048576"; // limit of the program's address space, kilobytes

fn record(path: &Path) {
    let run = [("program", "test"), ("job", "nothing"), ("seed", "7")];
    let run = run.map(|(key, value)| (key.to_owned(), value.to_owned())).into();
    let setup = Setup { epoch: Epoch::Fixed, run, cell: Some(CellModel::default()), ..Setup::default() };
    let mut recorder = Recorder::start(path, Pace::Wait, setup).expect("the log begins");
    let (mut ladder, mut memory) = (Ladder::default(), CommonMemory::default());
    for tick in (1..=TICKS).map(Tick) {
        let mut external = ExternalInputs::default();
        external.devices.joystick.velocity = 1000;
        external.hws.number = u32::from(tick.0 >= 50);
        external.hws.command = Name16::new("TRANSFER").expect("a word");
        external.hws.object = Some(Name16::new("NOBODY").expect("a word"));
        let before = memory;
        ladder.step(tick, &before, &external, &TaskData::default(), &mut memory);
        recorder.cell(&CellFrame::new(tick).with_digest(tick.0));
        recorder.timing(Timing { controller_ns: 1000, skipped: 0 });
        recorder.tick(tick, &external, &memory, || ladder.state());
    }
    recorder.finish(End { result: "failed".into(), ..End::default() }).expect("the log ends");
}

/// Runs `rcs-log` with limited memory.
fn rcs_log(arguments: &[&str], files: &[&Path]) -> Output {
    let mut command = Command::new("sh");
    command.args(["-c", "ulimit -v \"$0\" && exec \"$@\"", LIMIT, env!("CARGO_BIN_EXE_rcs-log")]);
    command.args(arguments).args(files).output().expect("sh runs")
}

/// Checks that the program ended normally, and printed a sentence if it has no answer.
fn assert_answered(output: &Output, what: &str) -> i32 {
    let said = String::from_utf8_lossy(&output.stderr);
    let status = output.status.code();
    assert!(
        matches!(status, Some(0..=2)) && !said.contains("panicked"),
        "{what}: {:?}: {said}",
        output.status
    );
    assert!(status != Some(2) || said.contains("rcs-log: "), "{what}: no sentence: {said}");
    status.unwrap()
}

fn with_a_bad_chunk(place: &Path) -> PathBuf {
    let path = place.join("middle.mcap");
    record(&path);
    let mut bytes = fs::read(&path).unwrap();
    let chunk = chunks(&bytes)[5];
    bytes[chunk + 200] ^= 0x55;
    fs::write(&path, bytes).unwrap();
    path
}

fn chunks(bytes: &[u8]) -> Vec<usize> {
    let (mut at, mut chunks) = (8, Vec::new());
    while at + 9 < bytes.len() {
        if bytes[at] == 6 {
            chunks.push(at);
        }
        at += 9 + usize::try_from(u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap())).unwrap();
    }
    chunks
}

#[test]
fn damage_in_the_middle_keeps_the_rest_readable() {
    let place = tempfile::tempdir().unwrap();
    let path = with_a_bad_chunk(place.path());
    let output = rcs_log(&["info", "--json"], &[&path]);
    let info: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(info["missing_ticks"], 25, "{info}");
    assert_eq!((&info["ticks"], &info["complete"]), (&(TICKS - 25).into(), &true.into()));
    assert!(info["damage"].as_str().unwrap().contains("damaged; their contents are missing"), "{info}");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("damaged"), "{said}");
    let output = rcs_log(&["replay"], &[&path]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && text.contains("ticks skipped") && text.contains("damaged"), "{text}");
}

#[test]
fn wrong_length_loses_one_chunk() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("length.mcap");
    record(&path);
    let mut bytes = fs::read(&path).unwrap();
    for wrong in [0_u64, 1 << 20, 1 << 40, u64::MAX] {
        let chunk = chunks(&fs::read(&path).unwrap())[5];
        bytes[chunk + 1..chunk + 9].copy_from_slice(&wrong.to_le_bytes());
        let log = Log::from_bytes(&path, bytes.clone()).unwrap();
        assert!(log.complete && log.end.is_some());
        assert_eq!(log.ticks().map(Result::unwrap).count(), 235, "length {wrong}");
    }
}

#[test]
fn only_regular_files_are_logs() {
    for file in ["/dev/zero", "/dev/stdin", "/"] {
        let output = rcs_log(&["info"], &[Path::new(file)]);
        assert_eq!(assert_answered(&output, file), 2);
    }
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("hole.mcap");
    File::create(&path).unwrap().set_len(1 << 40).unwrap();
    assert_eq!(assert_answered(&rcs_log(&["info"], &[&path]), "a hole"), 2);
}
