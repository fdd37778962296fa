//! `rcs-log why` on failures that were provoked: it must find the first cause, tell the commands that led there with their rows,
//! what was sensed meanwhile, and how the failure went up.

#![expect(clippy::print_stdout, reason = "what it says is what it is for")]

use std::process::Command;

use serde_json::Value;
use whole_system_tests::{Outcome, Scratch, rcs_log, root, run, run_with};

/// What `why` says of a log, for programs and for people.
fn why(outcome: &Outcome) -> (Value, String) {
    let ask = |arguments: &[&str]| {
        let output = Command::new(rcs_log())
            .arg("why")
            .args(arguments)
            .arg(&outcome.log)
            .output()
            .expect("rcs-log can be started");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let text = ask(&[]);
    println!("{text}");
    (serde_json::from_str(&ask(&["--json"])).expect("one JSON object"), text)
}

/// Names of the processes in a list of links, in its order.
fn processes(links: &Value) -> Vec<&str> {
    links.as_array().into_iter().flatten().filter_map(|link| link["process"].as_str()).collect()
}

/// A failure whose text holds all of `said`, whose first cause begins with the process, and whose commands lead there.
fn assert_explained(outcome: &Outcome, first: &str, commanders: &[&str], said: &[&str]) {
    let (answer, text) = why(outcome);
    let failure = &answer["failure"];
    let cause = failure["first_cause"].as_str().expect("a failure has a first cause");
    assert!(cause.starts_with(first), "{cause}");
    assert_eq!(processes(&failure["commands"]), commanders, "{text}");
    assert_eq!(processes(&failure["consequences"]).last(), Some(&"Task"), "{text}");
    for words in said {
        assert!(text.contains(words), "{words:?} is not in:\n{text}");
    }
}

#[test]
fn a_missing_part() {
    let outcome = run("linkbar.job", 1, "why-missing", |scratch: &Scratch| {
        scratch.job_with("linkbar.job", "** tray UNIT_1 4 LINKBAR1_BH", "%");
    });
    assert_explained(
        &outcome,
        "E-move at tick ",
        &["HWSC", "Task", "Subtask"],
        &[
            "vision sees no object",
            "Subtask commands E-move: LOCATE-OBJ LINKBAR1_BH",
            "tries is Spent",
            "vision.status",
        ],
    );
}

#[test]
fn a_tool_that_the_drum_holds() {
    let outcome = run("tool-change.job", 1, "why-held", |scratch: &Scratch| {
        scratch.job_with("tool-change.job", "** drum release", "%");
    });
    assert_explained(
        &outcome,
        "Prim at tick ",
        &["HWSC", "Task", "Subtask", "E-move"],
        &["guard is Met", "\"REM-FX\" (force fx on the tool) reached ", "and its threshold is 60 lb"],
    );
}

#[test]
fn a_drum_that_is_too_tight() {
    let outcome = run("tool-change", 1, "why-tight", |scratch: &Scratch| {
        scratch.data_with("cell.toml", "insertion_force = 30.0", "insertion_force = 95.0");
    });
    assert_explained(
        &outcome,
        "Prim at tick ",
        &["HWSC", "Task", "Subtask", "E-move"],
        &["E-move commands Prim: GO-WHILE INS-FX", "in that the tool went"],
    );
}

#[test]
fn a_pulled_cable() {
    let plan = root().join("data/faults/cable-pulled.toml");
    let plan = plan.to_str().expect("a path in UTF-8");
    let outcome = run_with("linkbar", 1, "why-cable", &["--faults", plan], |_| {});
    assert_explained(
        &outcome,
        "T3 Interface at tick 201, ",
        &["HWSC", "Task", "Subtask", "E-move", "Prim"],
        &[
            "not responding",
            "link_ready was true, then false at tick 201",
            "the faults of the run, at tick 2",
        ],
    );
}

#[test]
fn a_condition_that_never_comes() {
    let outcome = run("tool-change.job", 1, "why-threshold", |scratch: &Scratch| {
        scratch.data_with("guarded.blk", "HOL-R-SEAT   seated   1", "HOL-R-SEAT   beam     8");
        scratch.job_with("tool-change.job", "== ACQUIRE-TOOL", "== ACQUIRE-TOOL");
    });
    // E-move fails some ticks after Prim has missed: the chain goes back to that.
    assert_explained(
        &outcome,
        "Prim at tick ",
        &["HWSC", "Task", "Subtask", "E-move"],
        &[
            "E-move reports error-state",
            "Prim reports not-detected",
            "E-move commands Prim: GO-UNTIL HOL-R-SEAT",
            "\"HOL-R-SEAT\" (beam 8 between the fingers) never came true in the 2.00 in that the tool went",
        ],
    );
}

#[test]
fn a_run_that_no_process_failed() {
    let outcome = run("linkbar.job", 1, "why-vise", |scratch: &Scratch| {
        scratch.job_with("linkbar.job", "% Close vise\n** vise close PFIXTURE", "%");
    });
    let (answer, text) = why(&outcome);
    assert!(answer["failure"].is_null(), "{text}");
    assert!(text.starts_with("The run ended: HWSC: LINKBAR1_BH is to be machined"), "{text}");
}
