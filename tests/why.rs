//! `rcs-log why` finds the first cause, the commands before it with rows and sensed values, and the reports.

#![expect(clippy::print_stdout, reason = "its output is for readers")]

use std::process::Command;

use serde_json::Value;
use whole_system_tests::{Outcome, Scratch, rcs_log, rcs_run, root, run, run_with};

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

fn processes(links: &Value) -> Vec<&str> {
    links.as_array().into_iter().flatten().filter_map(|link| link["process"].as_str()).collect()
}

/// The text contains all of `said`, the first cause begins with the process, and the commands lead there.
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
fn missing_part_is_explained() {
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
fn tool_held_by_the_drum_is_explained() {
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
fn tight_drum_is_explained() {
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
fn pulled_cable_is_explained() {
    let plan = root().join("data/faults/cable-pulled.toml");
    let plan = plan.to_str().expect("a path in UTF-8");
    let outcome = run_with("linkbar", 1, "why-cable", &["--faults", plan], |_| {});
    assert_explained(
        &outcome,
        "a warning of the robot controller at tick 200: ",
        &["HWSC", "Task", "Subtask", "E-move", "Prim"],
        &[
            "not responding",
            "link_ready was true, then false at tick 201",
            "Injected faults, which this run was to simulate:",
        ],
    );
    let (answer, _) = why(&outcome);
    assert!(answer["faults"][0]["tick"].as_u64().is_some_and(|tick| tick <= 201), "{answer}");
    let account = [&answer["failure"]["first_cause"], &answer["world"]];
    assert!(
        account.iter().all(|part| !part.to_string().contains("fault")),
        "a fault is beside the account: {account:?}"
    );
}

#[test]
fn missing_sensor_condition_is_explained() {
    let outcome = run("tool-change.job", 1, "why-threshold", |scratch: &Scratch| {
        scratch.data_with("guarded.blk", "HOL-R-SEAT   seated   1", "HOL-R-SEAT   beam     8");
        scratch.job_with("tool-change.job", "== ACQUIRE-TOOL", "== ACQUIRE-TOOL");
    });
    // E-move fails some ticks after Prim's GO-UNTIL has missed. The chain begins with the missed motion.
    assert_explained(
        &outcome,
        "Prim at tick ",
        &["HWSC", "Task", "Subtask", "E-move"],
        &[
            "E-move reports error-state",
            "Prim reports not-detected",
            "E-move commands Prim: GO-UNTIL HOL-R-SEAT",
            "\"HOL-R-SEAT\" (beam 8 between the fingers) never came true in the 1.50 in that the tool went",
        ],
    );
}

#[test]
fn run_without_failed_process_is_explained() {
    let outcome = run("linkbar.job", 1, "why-vise", |scratch: &Scratch| {
        scratch.job_with("linkbar.job", "% Close vise\n** vise close PFIXTURE", "%");
    });
    let (answer, text) = why(&outcome);
    assert!(answer["failure"].is_null(), "{text}");
    assert!(text.starts_with("First, at tick "), "{text}");
    let world = answer["world"]["text"].as_str().expect("something went wrong");
    assert!(text.contains("The commands that led there:"), "{text}");
    assert_eq!(answer["world"]["tick"].as_u64(), outcome.result["failure"]["tick"].as_u64(), "{world}");
    assert!(text.contains("HWSC: LINKBAR1_BH is to be machined"), "{text}");
}

#[test]
fn contact_leads_to_the_data_line_of_the_motion() {
    let outcome = run_with("linkbar", 1, "why-contact", &["--unchecked"], Scratch::with_a_low_via_point);
    let (answer, text) = why(&outcome);
    let world = &answer["world"];
    assert_eq!(world["kind"], "collision", "{text}");
    assert!(world["text"].as_str().is_some_and(|said| said.contains("the robot ran into pot_")), "{text}");
    crate::faults::assert_same_account("a contact", &outcome);
    assert_eq!(world["tick"], outcome.result["contacts"][0]["tick"], "{text}");
    assert_eq!(processes(&world["commands"]), ["HWSC", "Task", "Subtask", "E-move"], "{text}");
    assert!(text.starts_with("First, at tick "), "{text}");
    assert!(text.contains("pose UNIT-V1: poses.blk, block "), "{text}");
    assert!(outcome.last_words.contains("in `== MOVE LINKBAR1_BH +2 UNIT_1 4"), "{}", outcome.last_words);
}

#[test]
fn a_resting_process_fires_no_row() {
    let outcome = run("rests.job", 1, "why-rests", |scratch| {
        let job = "== MOVE -- +0 -- 0 +0 SAFE 0 -- 0\n** wait 50\n";
        std::fs::write(scratch.file("rests.job"), job).expect("the job can be written");
    });
    let ended = outcome.result["ticks"].as_u64().expect("a run has ticks");
    let at = |tick: u64| {
        let mut ask = Command::new(rcs_log());
        ask.args(["why", "--json", "--tick"]).arg(tick.to_string()).arg(&outcome.log);
        let answer: Value = serde_json::from_slice(&ask.output().expect("rcs-log can be started").stdout)
            .expect("one JSON object");
        let old = |level: usize| answer["levels"][level]["old"].as_u64();
        (old(0), old(1), old(2))
    };
    let (task, subtask, emove) = at(ended - 10);
    assert!([task, subtask, emove].iter().all(|old| old.is_some_and(|tick| tick < ended - 40)), "{task:?}");
    assert_eq!(at(ended - 100), (None, None, None), "the robot moves");
}

/// The added pose precedes all others, and changes their numbers.
const ADDED_POSE: &str = "       0    -5022      736
       0    -7145    -1383
    3000    -7145    -1383   -pose-   ...         NEW-POS

       0    -5022      636
";

#[test]
fn added_data_do_not_change_runs_that_do_not_use_them() {
    let outcome = run("linkbar", 1, "why-added", |_| {});
    let scratch = Scratch::new("added");
    scratch.data_with("poses.blk", "       0    -5022      636\n", ADDED_POSE);
    let path = scratch.file("data/objects/linkbar.blk");
    let objects = std::fs::read_to_string(&path).expect("the objects can be read");
    let own = "-obj-  LINKBAR1_BH      2     0300   0060   30     0350\n";
    assert!(objects.contains(own));
    let added = format!("-obj-  LINKBAR2_BH      2     0300   0060   30     0350\n{own}");
    std::fs::write(&path, objects.replacen(own, &added, 1)).expect("the objects can be written");
    let replay = |data: &std::path::Path| {
        let output = Command::new(rcs_log()).args(["replay", "--data"]).arg(data).arg(&outcome.log).output();
        let output = output.expect("rcs-log can be started");
        (output.status.code(), String::from_utf8_lossy(&output.stdout).into_owned())
    };
    let (status, said) = replay(&scratch.file("data"));
    assert_eq!(status, Some(0), "{said}");
    let other = Scratch::new("moved");
    other.data_with(
        "movetables.blk",
        "    1    t      255     -525   -525",
        "    1    t      255     -525   -500",
    );
    let (status, said) = replay(&other.file("data"));
    assert_eq!(status, Some(1), "{said}");
}

#[test]
fn missed_grasp_names_the_forms_of_its_object() {
    let outcome = run_with("hinge", 1, "why-hinge", &["--unchecked"], |scratch| {
        scratch.copy_data();
        let data = scratch.file("data");
        let mut new = Command::new(rcs_run());
        new.args(["new", "part", "HINGE", "--size", "3x1.5x1", "--like", "LCLEVIS", "--write", "--data"]);
        let output = new.arg(&data).output().expect("rcs-run can be started");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        // The grip misses the half-finished part, so that the fingers close on nothing.
        let path = data.join("objects/hinge.blk");
        let text = std::fs::read_to_string(&path).expect("the forms are written");
        let missed = text.replacen("1 t 67 49 140 -mtb- HINGE-3", "1 t 67 400 140 -mtb- HINGE-3", 1);
        assert_ne!(missed, text);
        std::fs::write(&path, missed).expect("the forms can be written");
    });
    let (answer, text) = why(&outcome);
    let used: Vec<&str> =
        answer["world"]["data"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    let expected = [
        "point of the path: objects/hinge.blk, block 510 (offset 20000), line 13",
        "grip 1 of HINGE_IH at PFIXTURE: objects/hinge.blk, block 507 (offset 20000), line 3",
        "movetable HINGE-3 of the grip: objects/hinge.blk, block 506 (offset 20000), line 5",
        "sizes and force of grip 1 of HINGE_IH, 50 lb: objects/hinge.blk, block 502 (offset 20000), line 2",
        "location PFIXTURE: locations.blk, block 721 (offset 21000), line 7",
    ];
    assert_eq!(used, expected, "{text}");
}
