//! Tests the program `rcs-log` on logs that the recorder wrote.

use std::{
    fs, io,
    os::unix::fs::PermissionsExt as _,
    path::{Path, PathBuf},
    process::{Child, Command, Output, Stdio},
    thread,
    time::{Duration, Instant},
};

use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::Ladder;
use rcs_core::{Plain, digest::Digest, name::Name16, tick::Tick};
use record::{CellFrame, CellModel, End, Epoch, Pace, Recorder, Setup, explanation};
use taskdata::files::TaskData;
use tempfile::TempDir;

const TICKS: u64 = 120;
const COMMANDED: u64 = 50; // tick in which the workstation gives an impossible command

struct Scratch(TempDir);

impl Scratch {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a directory for scratch files"))
    }

    /// The log of a run without task data, in which TRANSFER fails; `speed` is the velocity knob.
    fn log(&self, name: &str, speed: u16) -> PathBuf {
        self.written(name, speed, COMMANDED, |_| 0)
    }

    fn log_commanded_at(&self, name: &str, commanded: u64) -> PathBuf {
        self.written(name, 1000, commanded, |_| 0)
    }

    fn log_of_cell(&self, name: &str, speed: u16, digest_of_cell: impl Fn(Tick) -> u64) -> PathBuf {
        self.written(name, speed, COMMANDED, digest_of_cell)
    }

    fn written(
        &self,
        name: &str,
        speed: u16,
        commanded: u64,
        digest_of_cell: impl Fn(Tick) -> u64,
    ) -> PathBuf {
        let path = self.0.path().join(name);
        let text = |key: &str, value: &str| (key.to_owned(), value.to_owned());
        let run = [text("program", "test"), text("job", "nothing"), text("seed", "7")].into();
        let cell = Some(CellModel::default());
        let attachments = explanation::attachments().into();
        let setup = Setup { epoch: Epoch::Fixed, run, attachments, cell };
        let mut recorder = Recorder::start(&path, Pace::Wait, setup).expect("the log begins");
        let (mut ladder, mut memory, mut digest) =
            (Ladder::default(), CommonMemory::default(), Digest::new());
        for tick in (1..=TICKS).map(Tick) {
            let mut external = ExternalInputs::default();
            external.devices.joystick.velocity = speed;
            external.hws.number = u32::from(tick.0 >= commanded);
            external.hws.command = Name16::new("TRANSFER").expect("a word");
            external.hws.object = Some(Name16::new("NOBODY").expect("a word"));
            let before = memory;
            ladder.step(tick, &before, &external, &TaskData::default(), &mut memory);
            digest.add_record(&memory, &mut [0; CommonMemory::SIZE]);
            recorder.cell(&CellFrame::new(tick).with_digest(digest_of_cell(tick)));
            recorder.tick(tick, &external, &memory, || ladder.state());
        }
        let end = End { digest: Some(digest.value()), result: "failed".into(), ..End::default() };
        recorder.finish(end).expect("the log ends");
        path
    }
}

fn rcs_log(arguments: &[&str], files: &[&Path]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rcs-log")).args(arguments).args(files).output().expect("rcs-log runs")
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn info_prints_commands_and_failure() {
    let scratch = Scratch::new();
    let log = scratch.log("run.mcap", 1000);
    let output = rcs_log(&["info"], &[&log]);
    let text = stdout(&output);
    assert!(output.status.success(), "{text}");
    assert!(text.contains("job nothing, seed 7"), "{text}");
    assert!(text.contains("120 ticks, 4.8 s; 0 ticks missing"), "{text}");
    assert!(text.contains("TRANSFER NOBODY"), "{text}");
    assert!(
        text.contains(
            "First, at tick 50 (2.00 s), a process error: Task: the object is not in the task data"
        ),
        "{text}"
    );

    let output = rcs_log(&["info", "--json"], &[&log]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    assert_eq!(json["commands"][0]["first_tick"], COMMANDED);
    assert_eq!(json["commands"][0]["status"], "error");
    assert_eq!(json["complete"], true);
}

#[test]
fn why_finds_the_tick_and_row_of_the_failure() {
    let scratch = Scratch::new();
    let log = scratch.log("run.mcap", 1000);
    let text = stdout(&rcs_log(&["why"], &[&log]));
    assert!(
        text.starts_with(
            "First, at tick 50 (2.00 s), a process error: Task: the object is not in the task data"
        ),
        "{text}"
    );
    assert!(
        text.contains("First cause: Task at tick 50, 0.00 s after its command: the object is not"),
        "{text}"
    );
    assert!(text.contains("  tick     50  HWSC commands Task: TRANSFER NOBODY, number 1\n"), "{text}");
    assert!(text.contains("In tick 50 (2.00 s), from Task down:"), "{text}");
    let output = rcs_log(&["why", "--json"], &[&log]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    let task = &json["levels"][0];
    let word = |key: &str| task[key].as_str().expect("a row fired").to_owned();
    let row = format!("{} row {}: {}", word("table"), task["row"], word("action"));
    assert!(text.contains(&row), "{row} in {text}");

    let output = rcs_log(&["why", "--tick", "7", "--json"], &[&log]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    assert_eq!(json["tick"], 7);
    assert_eq!(json["levels"][0]["process"], "Task");

    let output = rcs_log(&["why", "--tick", "4711"], &[&log]);
    assert_eq!(output.status.code(), Some(2));
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(text.contains("tick 4711 is not in the log, which has ticks 1 to 120"), "{text}");
}

#[test]
fn answer_without_a_reader_ends_quietly() {
    let scratch = Scratch::new();
    let log = scratch.log("run.mcap", 1000);
    for arguments in [&["why"][..], &["why", "--json"], &["info"], &["replay"], &["diff"]] {
        let (reader, writer) = io::pipe().expect("a pipe");
        drop(reader);
        let files = if arguments == ["diff"] { 2 } else { 1 };
        let mut command = Command::new(env!("CARGO_BIN_EXE_rcs-log"));
        command.args(arguments).args(vec![&log; files]);
        let output = command.stdout(writer).stderr(Stdio::piped()).spawn().and_then(Child::wait_with_output);
        let output = output.expect("rcs-log runs");
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        assert_eq!(String::from_utf8_lossy(&output.stderr), "", "{arguments:?}");
    }
}

#[test]
fn replay_takes_several_logs_and_names_unusable_ones() {
    let scratch = Scratch::new();
    let (one, two) = (scratch.log("one.mcap", 1000), scratch.log("two.mcap", 500));
    let output = rcs_log(&["replay"], &[&one, &two]);
    let text = stdout(&output);
    assert!(output.status.success(), "{text}");
    assert_eq!(text.matches(": same, 120 ticks").count(), 2, "{text}");

    let broken = scratch.0.path().join("broken.mcap");
    fs::write(&broken, b"no log").expect("a file");
    let output = rcs_log(&["replay"], &[&one, &broken]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stdout(&output).contains("broken.mcap"), "{}", stdout(&output));
}

#[test]
fn diff_names_the_first_field_and_counts_the_others() {
    let scratch = Scratch::new();
    let (one, two) = (scratch.log("one.mcap", 1000), scratch.log("two.mcap", 500));
    assert_eq!(rcs_log(&["diff"], &[&one, &one]).status.code(), Some(0));
    for align in ["tick", "command"] {
        let output = rcs_log(&["diff", "--align", align], &[&one, &two]);
        let text = stdout(&output);
        assert_eq!(output.status.code(), Some(1), "{text}");
        assert!(text.contains("120 ticks compared, 120 different; 0 only in the first log"), "{text}");
        assert!(
            text.contains("first      tick 1, external.devices.joystick.velocity: 1000 and 500"),
            "{text}"
        );
    }
}

#[test]
fn diff_begins_with_the_rows_motions_and_times_that_changed() {
    let scratch = Scratch::new();
    let (one, two) = (scratch.log("one.mcap", 1000), scratch.log_commanded_at("two.mcap", 70));
    let text = stdout(&rcs_log(&["diff"], &[&one, &two]));
    let row = "row        Task: the same rows, 20 ticks at other times, first in tick 50\n";
    let time = "time       TRANSFER NOBODY: error after 0 ticks (0.00 s); error after 0 ticks";
    assert!(text.contains(row) && !text.contains(time), "{text}");
    assert!(text.find(row) < text.find("first      tick 50"), "{text}");
}

#[test]
fn diff_reports_when_two_cells_begin_to_differ() {
    let scratch = Scratch::new();
    let one = scratch.log("one.mcap", 1000);
    let two = scratch.log_of_cell("two.mcap", 1000, |tick| u64::from(tick.0 >= 60) * 0xAB);
    let output = rcs_log(&["diff"], &[&one, &two]);
    let text = stdout(&output);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("120 ticks compared, 61 different"), "{text}");
    let first = "first      tick 60, cell.digest: 0000000000000000 and 00000000000000ab";
    assert!(text.contains(first), "{text}");
}

#[test]
fn page_writes_one_file_with_the_log_inside() {
    let scratch = Scratch::new();
    let log = scratch.log("run.mcap", 1000);
    let output = rcs_log(&["page"], &[&log]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = fs::read_to_string(log.with_extension("html")).expect("the page is there");
    assert!(page.contains("<title>run.mcap</title>"));
    // The log begins with the magic of an MCAP file, in base64.
    assert!(page.contains("id=\"log-data\">iU1DQVAwDQo"));
    assert!(page.contains("default-src 'none'"), "the page loads nothing");
    let output = rcs_log(&["page", "--output", "/nowhere/page.html"], &[&log]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn open_starts_the_browser_if_there_is_one() {
    let scratch = Scratch::new();
    let log = scratch.log("run.mcap", 1000);
    let page = log.with_extension("html");
    let programs = log.with_file_name("programs");
    fs::create_dir(&programs).expect("a directory");
    let open = || {
        let program = env!("CARGO_BIN_EXE_rcs-log");
        let output = Command::new(program).arg("open").arg(&log).env("PATH", &programs).output();
        let output = output.expect("rcs-log starts");
        assert!(output.status.success());
        String::from_utf8(output.stderr).expect("a text")
    };
    let without = open();
    assert!(without.contains(&format!("open {} in one", page.display())), "{without}");
    assert!(fs::read_to_string(&page).expect("the page is there").contains("id=\"log-data\">"));
    let (browser, opened) = (programs.join("xdg-open"), log.with_file_name("opened"));
    fs::write(&browser, format!("#!/bin/sh\necho \"$1\" > {}\n", opened.display())).expect("a script");
    fs::set_permissions(&browser, fs::Permissions::from_mode(0o755)).expect("it can be executed");
    let with = open();
    assert!(!with.contains(" in one"), "{with}");
    let until = Instant::now() + Duration::from_secs(10);
    while fs::read_to_string(&opened).unwrap_or_default().trim() != page.display().to_string() {
        assert!(Instant::now() < until, "the browser was not started");
        thread::sleep(Duration::from_millis(20));
    }
}
