//! Loss of standard output and standard error: a tool ends quietly, and a run continues.

use std::{
    fs::File,
    io::{self, Read},
    os::fd::OwnedFd,
    path::Path,
    process::{Command, Output, Stdio},
};

use rustix::pty;

use crate::common::command;

/// A pipe whose reader has closed it, as in `rcs-run | head`.
fn closed_pipe() -> Stdio {
    let (reader, writer) = io::pipe().unwrap();
    drop(reader);
    writer.into()
}

fn full() -> Stdio {
    File::options().write(true).open("/dev/full").unwrap().into()
}

fn terminal() -> (OwnedFd, File) {
    let master = pty::openpt(pty::OpenptFlags::RDWR | pty::OpenptFlags::NOCTTY).unwrap();
    pty::unlockpt(&master).unwrap();
    let name = pty::ptsname(&master, Vec::new()).unwrap();
    let flags = rustix::fs::OFlags::RDWR | rustix::fs::OFlags::NOCTTY;
    let slave = rustix::fs::open(&*name, flags, rustix::fs::Mode::empty()).unwrap();
    (master, slave.into())
}

fn closed_terminal() -> Stdio {
    let (master, slave) = terminal();
    drop(master);
    slave.into()
}

const LOST: [fn() -> Stdio; 3] = [closed_pipe, full, closed_terminal]; // all ways to lose a stream

/// A job that fails, with a sentence on standard error.
const FAILS: &str = "** tray UNIT_1 4 LINKBAR1_BH 0 0 0\n** tray UNIT_1 4 LINKBAR1_BH 0 0 0\n";

/// A run into a log in `place`, with the streams as set by `streams`, has the status and a log with its end.
fn assert_run(
    place: &Path,
    arguments: &[&str],
    status: i32,
    streams: impl FnOnce(&mut Command) -> &mut Command,
) {
    let log = place.join("run.mcap");
    let mut command = command(arguments);
    let output = streams(command.arg("--log").arg(&log)).output().unwrap();
    assert_eq!(output.status.code(), Some(status), "{arguments:?}: {}", text(&output.stderr));
    let log = record::Log::open(&log).unwrap();
    assert!(log.complete && log.end.is_some(), "{arguments:?}: the log has no end");
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn run_continues_without_standard_error() {
    let place = tempfile::tempdir().unwrap();
    let job = place.path().join("fails.job");
    std::fs::write(&job, FAILS).unwrap();
    let fails = job.to_str().unwrap();
    for (way, lost) in LOST.into_iter().enumerate() {
        let ticks = ["--ticks", "40", "--shared-memory", "on"];
        assert_run(place.path(), &ticks, 0, |command| command.stderr(lost()));
        assert_run(place.path(), &[fails], 1, |command| command.stderr(lost()));
        // Boards write to the standard error of the run.
        assert_run(place.path(), &["--boards", "split", "--ticks", "40"], 0, |command| {
            command.stderr(lost())
        });
        let unusable = command(&["--data", "/nowhere"]).stderr(lost()).output().unwrap();
        assert_eq!(unusable.status.code(), Some(2), "way {way}");
    }
}

#[test]
fn closed_terminal_does_not_end_the_run() {
    let place = tempfile::tempdir().unwrap();
    let (master, slave) = terminal();
    let log = place.path().join("run.mcap");
    let child = command(&["--clock", "real", "--ticks", "60", "--log", log.to_str().unwrap()])
        .stderr(slave)
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    // The first bytes on the terminal are those of the progress.
    let mut reader = File::from(master);
    reader.read_exact(&mut [0; 16]).unwrap();
    drop(reader);
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(0));
    assert!(record::Log::open(&log).unwrap().complete);
}

/// Runs a program whose standard output is lost; returns its standard error.
fn without_output(arguments: &[&str], lost: Stdio) -> Output {
    command(arguments).stdout(lost).stderr(Stdio::piped()).spawn().unwrap().wait_with_output().unwrap()
}

const TOOLS: [&[&str]; 9] = [
    &["check"],
    &["check", "--json"],
    &["check", "--explain-job", "linkbar"],
    &["check", "--explain", "MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0"],
    &["tables"],
    &["latency", "--seconds", "1"],
    &["latency", "--seconds", "1", "--json"],
    &["campaign", "linkbar", "--at", "15", "--interrupt", "none"],
    &["clean"],
];

#[test]
fn tool_without_a_reader_ends_quietly() {
    for arguments in TOOLS {
        let with_reader = command(arguments).output().unwrap();
        let output = without_output(arguments, closed_pipe());
        assert_eq!(output.status.code(), with_reader.status.code(), "{arguments:?}");
        assert_eq!(text(&output.stderr), text(&with_reader.stderr), "{arguments:?}");
    }
}

#[test]
fn answer_on_a_full_disk_is_an_error() {
    for arguments in TOOLS {
        let output = without_output(arguments, full());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let said = text(&output.stderr);
        assert!(
            said.contains("No space left on device") && !said.contains("panicked"),
            "{arguments:?}: {said}"
        );
    }
}

#[test]
fn run_without_a_reader_keeps_its_status() {
    let place = tempfile::tempdir().unwrap();
    assert_run(place.path(), &["--ticks", "40"], 0, |command| command.stdout(closed_pipe()));
    assert_run(place.path(), &["--ticks", "40"], 0, |command| {
        command.stdout(closed_pipe()).stderr(closed_pipe())
    });
}
