//! Ends by the user: signals, a lost terminal, the background of a shell.

use std::{
    fs::File,
    io::Read,
    os::fd::OwnedFd,
    path::Path,
    process::{Child, Command, Output, Stdio},
    thread,
    time::{Duration, Instant},
};

use record::Log;
use rustix::{
    fs::{Mode, OFlags, open},
    process::{Pid, Signal, kill_process},
    pty,
    termios::{Winsize, tcsetwinsize},
};
use tempfile::tempdir;
use whole_system_tests::{rcs_console, rcs_run, root};

const TIME_LIMIT: Duration = Duration::from_secs(60); // of each action
const STOPPED: Option<i32> = Some(3); // stopped by the user

fn wait_for(mut condition: impl FnMut() -> bool) {
    let started = Instant::now();
    while !condition() {
        assert!(started.elapsed() < TIME_LIMIT, "it did not happen within a minute");
        thread::sleep(Duration::from_millis(20));
    }
}

fn moving(log: &Path) -> Child {
    let child = Command::new(rcs_run())
        .args(["linkbar", "--clock", "real", "--json", "--log"])
        .arg(log)
        .current_dir(root())
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    wait_for(|| std::fs::metadata(log).is_ok_and(|log| log.len() > 500_000));
    child
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// `timeout 5 rcs-run --clock real` signals its child and its process group.
#[test]
fn two_signals_at_once_stop_a_run_in_order() {
    let place = tempdir().unwrap();
    let log = place.path().join("run.mcap");
    let child = moving(&log);
    let pid = Pid::from_child(&child);
    for signal in [Signal::TERM, Signal::TERM, Signal::CONT, Signal::HUP] {
        kill_process(pid, signal).unwrap();
        thread::sleep(Duration::from_millis(50));
    }
    let output = child.wait_with_output().unwrap();
    let said = said(&output);
    assert_eq!(output.status.code(), STOPPED, "{said}");
    let result: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(result["ending"], "stopped");
    assert!(result["failure"].is_null(), "{}", result["failure"]);
    assert!(result["ramp_ticks"].as_u64() > Some(0), "{result}");
    assert!(said.contains("the robot ramps to rest, then the run ends"), "{said}");
    assert!(said.contains("Ctrl-C again ends the run at once"), "{said}");
    assert!(said.lines().last().unwrap().starts_with("rcs-run: linkbar was stopped by the user"), "{said}");
    let log = Log::open(&log).unwrap();
    assert!(log.complete && log.end.is_some(), "the log has no end");
}

/// Both ends of a terminal, which child processes do not inherit.
fn terminal() -> (File, OwnedFd) {
    let flags = pty::OpenptFlags::RDWR | pty::OpenptFlags::NOCTTY | pty::OpenptFlags::CLOEXEC;
    let master = pty::openpt(flags).unwrap();
    pty::unlockpt(&master).unwrap();
    let name = pty::ptsname(&master, Vec::new()).unwrap();
    let slave = open(&*name, OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC, Mode::empty()).unwrap();
    let size = Winsize { ws_row: 24, ws_col: 80, ws_xpixel: 0, ws_ypixel: 0 };
    tcsetwinsize(&slave, size).unwrap();
    (File::from(master), slave)
}

/// `tmux kill-session` with `rcs-run --console`. The run waits for its console, so both have ended.
#[test]
fn lost_terminal_ends_console_and_run() {
    assert!(rcs_console().is_file());
    let place = tempdir().unwrap();
    let log = place.path().join("run.mcap");
    let (mut screen, slave) = terminal();
    let end = || slave.try_clone().unwrap();
    let mut child = Command::new(rcs_run())
        .args(["linkbar", "--console", "--log"])
        .arg(&log)
        .current_dir(root())
        .stdin(end())
        .stdout(end())
        .stderr(end())
        .spawn()
        .unwrap();
    drop(slave);
    let mut shown = Vec::new();
    while !String::from_utf8_lossy(&shown).contains("OPERATOR") {
        let mut bytes = [0; 4096];
        let count = screen.read(&mut bytes).unwrap();
        shown.extend_from_slice(&bytes[..count]);
    }
    drop(screen);
    let begun = Instant::now();
    while child.try_wait().unwrap().is_none() && begun.elapsed() < TIME_LIMIT {
        thread::sleep(Duration::from_millis(20));
    }
    let _ = child.kill(); // a failed test leaves no program running
    assert_eq!(child.wait().unwrap().code(), STOPPED, "after {:?}", begun.elapsed());
    assert!(Log::open(&log).unwrap().complete);
}

fn in_a_shell(line: &str) -> String {
    let command = format!("bash -c 'set -m; {line}'");
    let output = Command::new("script")
        .args(["--quiet", "--return", "--command", &command, "/dev/null"])
        .stdin(Stdio::null())
        .current_dir(root())
        .output()
        .unwrap();
    String::from_utf8_lossy(&output.stdout).into_owned()
}

#[test]
fn a_run_in_the_background_draws_no_progress() {
    let run = format!("{} --ticks 50 --clock real --log none --shared-memory off", rcs_run().display());
    let progress = "Task: PAUSE"; // only in the progress line
    let foreground = in_a_shell(&run);
    assert!(foreground.contains(progress), "{foreground}");
    let background = in_a_shell(&format!("{run} & wait"));
    assert!(background.contains("stopped as requested"), "{background}");
    assert!(!background.contains(progress), "{background}");
}
