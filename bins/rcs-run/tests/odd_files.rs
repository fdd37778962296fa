//! Special files, file size limits, and signals: a run is refused with a message, or ends orderly.

use std::{
    fs,
    os::unix::fs::symlink,
    path::Path,
    process::{Child, Command, Output, Stdio},
    time::{Duration, Instant},
};

use rustix::{
    fs::{CWD, Mode, mkfifoat},
    process::{Pid, Signal, kill_process},
};

use crate::common::data::copy;
use crate::common::{command, root};

fn said(output: &Output) -> String {
    let said = String::from_utf8_lossy(&output.stderr);
    said.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Waits for a program that must end by itself. It would never end if it waited for a FIFO.
fn ended(mut child: Child) -> Output {
    let started = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if started.elapsed() > Duration::from_secs(60) {
            child.kill().unwrap();
            panic!("it waits: {}", said(&child.wait_with_output().unwrap()));
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    child.wait_with_output().unwrap()
}

fn run(arguments: &[&str]) -> Output {
    ended(command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap())
}

fn fifo(path: &Path) -> &str {
    mkfifoat(CWD, path, Mode::RUSR | Mode::WUSR).unwrap();
    path.to_str().unwrap()
}

#[test]
fn fifos_and_devices_are_refused_with_a_message() {
    let place = tempfile::tempdir().unwrap();
    let pipe = fifo(&place.path().join("pipe")).to_owned();
    for (option, file, found) in [
        ("--faults", pipe.as_str(), "a FIFO"),
        ("--faults", "/dev/zero", "a device"),
        ("--log", &pipe, "a FIFO"),
        ("--log", "/dev/zero", "a device"),
        ("--log", "/dev", "a directory"),
    ] {
        let output = run(&[option, file, "--ticks", "10"]);
        assert_eq!(output.status.code(), Some(2), "{option} {file}");
        assert!(
            said(&output).contains(&format!("a regular file was expected, found {found}")),
            "{}",
            said(&output)
        );
    }
    let job = run(&[&pipe, "--log", "none"]);
    assert_eq!(job.status.code(), Some(2), "{}", said(&job));
    for name in ["cell.toml", "pipe.blk", "jobs/pipe.job"] {
        let data = place.path().join("data").join(name.replace(['/', '.'], "-"));
        copy(&root().join("data"), &data);
        drop(fs::remove_file(data.join(name)));
        fifo(&data.join(name));
        let output = run(&["check", data.to_str().unwrap()]);
        assert_eq!(output.status.code(), Some(2), "{name}");
        let said = said(&output) + &String::from_utf8_lossy(&output.stdout);
        assert!(said.contains("found a FIFO"), "{name}: {said}");
    }
}

#[test]
fn log_to_the_null_device_is_not_written() {
    let output = run(&["--log", "/dev/null", "--ticks", "10", "--json"]);
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((output.status.code(), &result["log"]), (Some(0), &serde_json::Value::Null));
}

#[test]
fn cyclic_link_is_followed_once() {
    let place = tempfile::tempdir().unwrap();
    let data = place.path().join("data");
    copy(&root().join("data"), &data);
    symlink("..", data.join("back")).unwrap();
    symlink(".", data.join("here")).unwrap();
    let output = run(&["check", data.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stdout));
}

#[test]
fn file_size_limit_ends_the_log_but_not_the_run() {
    let place = tempfile::tempdir().unwrap();
    let log = place.path().join("run.mcap");
    // The limit counts blocks of 512 or 1024 bytes. Both are more than the log's head and less than the whole log.
    let output = Command::new("sh")
        .args(["-c", "ulimit -f 3000 && exec \"$@\"", "sh", env!("CARGO_BIN_EXE_rcs-run")])
        .args(["linkbar", "--shared-memory", "off", "--log", log.to_str().unwrap()])
        .current_dir(root())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert!(said(&output).contains("the log ended before the run did"), "{}", said(&output));
    let page = String::from_utf8(output.stdout).unwrap();
    assert!(page.contains("run.mcap is incomplete: the log could not be written further"), "{page}");
    assert!(!page.contains("\nwatch"), "commands need a complete log: {page}");
}

#[test]
fn log_head_above_the_size_limit_is_not_begun() {
    let place = tempfile::tempdir().unwrap();
    let log = place.path().join("run.mcap");
    let output = Command::new("sh")
        .args(["-c", "ulimit -f 1 && exec \"$@\"", "sh", env!("CARGO_BIN_EXE_rcs-run")])
        .args(["linkbar", "--shared-memory", "off", "--log", log.to_str().unwrap()])
        .current_dir(root())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    assert!(said(&output).contains("the log could not be started: File too large"), "{}", said(&output));
}

#[test]
fn printed_commands_quote_odd_paths() {
    let place = tempfile::tempdir().unwrap();
    let name = "a\nlog\tof \u{202e}mine.mcap";
    let log = place.path().join(name);
    let output =
        run(&["vise-and-back", "--ticks", "5", "--shared-memory", "off", "--log", log.to_str().unwrap()]);
    let page = String::from_utf8(output.stdout).unwrap();
    let word = format!(r"$'{}/a\nlog\tof \342\200\256mine.mcap'", place.path().display());
    for line in [format!("\nlog        {word} ("), format!(" why {word}\n"), format!("--log {word}\n")] {
        assert!(page.contains(&line), "{line}: {page}");
    }
    assert!(!page.contains('\u{202e}'));
}

#[test]
fn hang_up_ends_a_run_in_order() {
    let place = tempfile::tempdir().unwrap();
    for boards in ["one", "split"] {
        let log = place.path().join(boards).with_extension("mcap");
        let arguments = ["--clock", "real", "--boards", boards, "--log", log.to_str().unwrap()];
        let child = command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let started = Instant::now();
        while fs::metadata(&log).map_or(0, |log| log.len()) == 0 {
            assert!(started.elapsed() < Duration::from_secs(60), "the run does not begin");
            std::thread::sleep(Duration::from_millis(20));
        }
        kill_process(Pid::from_child(&child), Signal::HUP).unwrap();
        let output = ended(child);
        assert_eq!(output.status.code(), Some(3), "{}", said(&output));
        assert!(said(&output).contains("was stopped by the user"), "{}", said(&output));
        assert!(record::Log::open(&log).unwrap().complete);
    }
}
