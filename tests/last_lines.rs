//! The last lines of a run: places of the parts, then commands that can be pasted into a shell.

use std::{
    fs,
    io::Read as _,
    path::Path,
    process::{Command, Stdio},
};

use rustix::process::{Pid, Signal, kill_process};
use whole_system_tests::{Scratch, bench::wait_for, rcs_console, rcs_log, rcs_run};

/// A command that starts a program by its path, not by cargo, with both outputs in one stream.
fn on_terminal(scratch: &Scratch, line: &str) -> Command {
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!("exec {line} 2>&1")]).current_dir(scratch.file("."));
    shell.env_remove("CARGO_MANIFEST_DIR");
    shell
}

fn shown(scratch: &Scratch, line: &str) -> (String, bool) {
    let output = on_terminal(scratch, line).output().expect("a shell can be started");
    (String::from_utf8_lossy(&output.stdout).into_owned(), output.status.success())
}

fn run(scratch: &Scratch, arguments: &str) -> String {
    shown(scratch, &format!("{} {arguments}", rcs_run().display())).0
}

fn command<'o>(output: &'o str, label: &str) -> &'o str {
    let line = output.lines().find_map(|line| line.strip_prefix(label));
    line.unwrap_or_else(|| panic!("no line {label:?} in\n{output}")).trim()
}

fn line_of(output: &str, start: &str) -> usize {
    let found: Vec<_> =
        output.lines().enumerate().filter(|(_, line)| line.starts_with(start)).map(|(at, _)| at).collect();
    assert_eq!(found.len(), 1, "{start:?} in\n{output}");
    found[0]
}

#[test]
fn finished_run_ends_with_the_place_of_the_part_and_the_next_commands() {
    let (_, _) = (rcs_log(), rcs_console()); // the commands need the other programs next to rcs-run
    let scratch = Scratch::new("last-finished");
    let output = run(&scratch, "linkbar");
    let lines: Vec<_> = output.lines().collect();
    let [.., part, empty, watch, look, open, why] = lines[..] else { panic!("{output}") };
    assert!(part.starts_with("LINKBAR1 is at UNIT_1 sector 1, "), "{output}");
    assert_eq!(empty, "");
    assert!(watch.starts_with("watch ") && why.starts_with("ask why "), "{output}");
    let (script, layout) = opened(open);
    assert!(script.ends_with("viewers/rerun.sh runs/linkbar.mcap"), "{output}");
    assert!(Path::new(layout).is_file(), "{output}");
    // Fast clock has no timing.
    for timing in [" p50 ", "slowest", "punctual", "slots skipped"] {
        assert!(!output.contains(timing), "{timing} in\n{output}");
    }
    let (screen, is_shown) = shown(&scratch, &format!("{} --once ladder", command(&output, "watch")));
    assert!(is_shown && screen.contains("E-move"), "{screen}");
    assert!(look.starts_with("look "), "{output}");
    let (page, is_written) = shown(&scratch, command(&output, "look"));
    assert!(is_written && scratch.file("runs/linkbar.html").is_file(), "{page}");
    let (why, is_answered) = shown(&scratch, command(&output, "ask why"));
    assert!(is_answered && !why.is_empty(), "{why}");
}

fn opened(line: &str) -> (&str, &str) {
    let (command, hint) = line.strip_prefix("open ").and_then(|line| line.split_once('#')).expect(line);
    let (_, layout) = hint.rsplit_once(' ').expect(line);
    (command.trim(), layout)
}

fn succeeds(program: &str, arguments: &[&str]) -> bool {
    let status = Command::new(program).args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).status();
    status.is_ok_and(|status| status.success())
}

/// Rerun without a screen, and Lichtblick if `RCS_LICHTBLICK` is a web build; `viewers/check.py` looks.
#[test]
fn printed_commands_show_the_robot_in_the_viewers() {
    let packages = "import rerun, mcap, mcap_protobuf, PIL, websockets";
    let has_rerun = succeeds("python3", &["-c", packages])
        && succeeds("rerun", &["--version"])
        && succeeds("xvfb-run", &["--help"]);
    let lichtblick = std::env::var("RCS_LICHTBLICK").ok();
    if !has_rerun && lichtblick.is_none() {
        eprintln!(
            "skipped: rerun, its Python packages (docs/logs.md) and xvfb-run are needed, or RCS_LICHTBLICK"
        );
        return;
    }
    let scratch = Scratch::new("last-viewers");
    let output = run(&scratch, "linkbar");
    let (command, layout) = opened(output.lines().find(|line| line.starts_with("open ")).expect(&output));
    let check = Path::new(layout).with_file_name("check.py");
    let check = format!("python3 {} runs/linkbar.mcap --layout {layout}", check.display());
    if has_rerun {
        let (found, is_shown) = shown(&scratch, &format!("{check} --rerun --command '{command}'"));
        assert!(is_shown, "{found}");
    }
    if let Some(directory) = lichtblick {
        let (found, is_shown) = shown(&scratch, &format!("{check} --lichtblick '{directory}'"));
        assert!(is_shown, "{found}");
    }
}

#[test]
fn failed_run_ends_with_reason_then_part_then_commands() {
    let (_, _) = (rcs_log(), rcs_console());
    let scratch = Scratch::new("last-failed");
    let output = run(&scratch, "--faults air-lost --log \"it's my run.mcap\"");
    let reason = line_of(&output, "rcs-run: linkbar failed at tick ");
    let part = line_of(&output, "LINKBAR1_BH is clamped in PFIXTURE");
    let watch = line_of(&output, "watch ");
    assert!(reason < part && part < watch, "{output}");
    // The file name contains a blank and an apostrophe.
    let (why, is_answered) = shown(&scratch, command(&output, "ask why"));
    assert!(is_answered && why.contains("air"), "{why}");
    let watch = command(&output, "watch");
    let (_, tick) = watch.rsplit_once(" --tick ").expect("the screen of the failure");
    let (screen, is_shown) = shown(&scratch, &format!("{watch} --once ladder"));
    assert!(is_shown && screen.contains(tick), "{screen}");
}

#[test]
fn run_without_part_and_log_prints_no_commands() {
    let scratch = Scratch::new("last-none");
    let output = run(&scratch, "--faults blank-missing --log none");
    assert_eq!(output.lines().last(), Some("No part is in the cell."), "{output}");
}

#[test]
fn interrupted_run_in_real_time_has_its_times_and_the_last_lines() {
    let scratch = Scratch::new("last-stopped");
    let line = format!("{} --clock 20x", rcs_run().display());
    let mut run =
        on_terminal(&scratch, &line).stdout(Stdio::piped()).spawn().expect("a shell can be started");
    // By then the blank has been delivered; the robot may already hold it.
    let log = scratch.file("runs/linkbar.mcap");
    wait_for("a part of the run", || fs::metadata(&log).is_ok_and(|log| log.len() > 1_500_000));
    kill_process(Pid::from_child(&run), Signal::INT).expect("the run has not ended");
    let mut output = String::new();
    run.stdout.take().expect("it is piped").read_to_string(&mut output).expect("text");
    run.wait().expect("the run ends");
    assert!(line_of(&output, "LINKBAR1_BH is ") < line_of(&output, "watch "), "{output}");
    assert!(output.contains("controller ") && output.contains(" skipped; allocations"), "{output}");
    assert!(output.contains("slowest "), "{output}");
}
