//! Tool commands at an occupied or empty drum: the reported failure is right, nothing is damaged, and the remedy works.

use std::fs;

use serde_json::Value;
use whole_system_tests::{Outcome, Scratch, run_with};

const OCCUPIED: &str = "\
** drum tool DRILL-2
** tray UNIT_2 1 ENDMILL-1 0 0 0
== MOVE ENDMILL-1 +1 UNIT_2 1 +1 TOOL-SAFE 0 -- 0
";
const INSERT: &str = "== INSERT-TOOL ENDMILL-1 +1 -- 0 +1 TOOL-SAFE 0 -- 0";
const ACQUIRE: &str = "== ACQUIRE-TOOL DRILL-2 +1 -- 0 +1 TOOL-SAFE 0 -- 0";
const NOT_FREE: &str = "the tool meets something in front of the drum";
const UNCONFIRMED: &str = "the tool in the drum (the drum has no sensor)"; // after INSERT-TOOL or RELEASE-TOOL

fn job(name: &str, text: &str) -> Outcome {
    let file = format!("{name}.job");
    run_with(&file, 1, name, &["--unchecked"], |scratch: &Scratch| {
        fs::write(scratch.file(&file), text).expect("the job can be written");
    })
}

fn part<'a>(outcome: &'a Outcome, name: &str) -> &'a Value {
    let parts = outcome.result["parts"].as_array().expect("a result has parts");
    parts.iter().find(|part| part["name"] == name).expect("the part is in the cell")
}

fn statuses(outcome: &Outcome) -> Vec<&str> {
    let commands = outcome.result["commands"].as_array().expect("a result has commands");
    commands.iter().filter_map(|command| command["status"].as_str()).collect()
}

/// No forbidden contact, and the tool in the drum is in place.
fn assert_undamaged(outcome: &Outcome) {
    assert_eq!(outcome.result["contacts"], Value::Array(Vec::new()), "{}", outcome.last_words);
    let events = outcome.result["events"]["first"].as_array().expect("a result has events");
    assert!(events.iter().all(|event| event["code"] != "cell.slipped"), "{events:?}");
    let drill = part(outcome, "DRILL-2");
    assert_eq!(drill["location"], "TOOL-TRNS", "{drill}");
    assert!(drill["error_in"].as_f64().is_some_and(|error| error < 0.02), "{drill}");
    let mill = part(outcome, "ENDMILL-1");
    assert_eq!(mill["held"], true, "{mill}");
}

#[test]
fn insert_tool_into_an_occupied_drum_fails_before_anything_is_damaged() {
    let outcome = job("drum-occupied", &format!("{OCCUPIED}{INSERT}\n"));
    assert_eq!(outcome.status, Some(1), "{}", outcome.last_words);
    assert_eq!(outcome.result["failure"]["process"], "E-move");
    assert!(outcome.last_words.contains(NOT_FREE), "{}", outcome.last_words);
    assert_undamaged(&outcome);
}

#[test]
fn an_occupied_drum_is_emptied_and_the_insertion_finishes() {
    let remedy = "\
== REMOVE-TOOL ENDMILL-1 +1 -- 0 +1 -- 0 TOOL-SAFE 0
== TRANSFER ENDMILL-1 +1 TOOL-SAFE 0 +1 UNIT_2 1 -- 0
== ACQUIRE-TOOL DRILL-2 +1 -- 0 +1 TOOL-SAFE 0 -- 0
** drum release
== REMOVE-TOOL DRILL-2 +1 -- 0 +1 -- 0 TOOL-SAFE 0
== TRANSFER DRILL-2 +1 TOOL-SAFE 0 +1 UNIT_2 3 -- 0
== MOVE ENDMILL-1 +1 UNIT_2 1 +1 TOOL-SAFE 0 -- 0
";
    let last = "** drum grip\n== RELEASE-TOOL ENDMILL-1 +1 -- 0 +1 -- 0 TOOL-SAFE 0\n";
    let text = format!("{OCCUPIED}{INSERT} expect error\n{remedy}{INSERT}\n{last}");
    let outcome = job("drum-emptied", &text);
    assert_eq!(outcome.status, Some(0), "{}", outcome.last_words);
    let mill = part(&outcome, "ENDMILL-1");
    assert_eq!(mill["location"], "TOOL-TRNS", "{mill}");
    assert!(mill["error_in"].as_f64().is_some_and(|error| error < 0.15), "{mill}");
    let commands = outcome.result["commands"].as_array().expect("a result has commands");
    let unconfirmed = commands.iter().filter(|command| command["unconfirmed"] == UNCONFIRMED).count();
    assert_eq!(unconfirmed, 2, "INSERT-TOOL and RELEASE-TOOL: {commands:?}");
}

#[test]
fn acquire_tool_from_an_empty_drum_fails_with_a_working_remedy() {
    let outcome = job("drum-empty", &format!("{ACQUIRE}\n"));
    assert_eq!(outcome.status, Some(1), "{}", outcome.last_words);
    let said = &outcome.last_words;
    assert!(said.contains("the tool is not in the drum"), "{said}");
    assert!(said.contains("send RELEASE-TOOL with the end-at location TOOL-SAFE"), "{said}");
    let text = format!(
        "{ACQUIRE} expect error\n\
         == RELEASE-TOOL DRILL-2 +1 -- 0 +1 -- 0 TOOL-SAFE 0\n\
         ** drum tool DRILL-2\n\
         {ACQUIRE}\n\
         ** drum release\n\
         == REMOVE-TOOL DRILL-2 +1 -- 0 +1 -- 0 TOOL-SAFE 0\n"
    );
    let outcome = job("drum-filled", &text);
    assert_eq!(outcome.status, Some(0), "{}", outcome.last_words);
    // The first command is the PAUSE of the start.
    assert_eq!(statuses(&outcome)[1..], ["error as expected", "finished", "finished", "finished"]);
    assert_eq!(outcome.result["commands"][2]["unconfirmed"], UNCONFIRMED, "no tool was released");
    assert_eq!(part(&outcome, "DRILL-2")["held"], true);
}

fn interrupted(ticks: u32) -> String {
    format!(
        "** after {ticks} joystick frame WORLD\n\
         ** after {ticks} joystick stick 0 50 2\n\
         {INSERT} expect error\n\
         ** joystick frame OFF\n\
         ** wait 25\n\
         == PAUSE -- 0 -- 0 0 -- 0 -- 0\n"
    )
}

#[test]
fn an_interrupted_insertion_into_an_occupied_drum_never_finishes() {
    // The stops are during the calibration of the sensor, in the motion, before the contact, and in contact.
    for ticks in [3, 12, 60, 130, 190, 214] {
        let text = format!("{OCCUPIED}{}{INSERT}\n", interrupted(ticks));
        let outcome = job(&format!("drum-interrupted-{ticks}"), &text);
        assert_eq!(outcome.status, Some(1), "{ticks}: {}", outcome.last_words);
        assert!(outcome.last_words.contains(NOT_FREE), "{ticks}: {}", outcome.last_words);
        assert_undamaged(&outcome);
    }
}

#[test]
fn tool_added_to_the_drum_during_an_interruption_is_detected() {
    let text = format!(
        "** tray UNIT_2 1 ENDMILL-1 0 0 0\n\
         == MOVE ENDMILL-1 +1 UNIT_2 1 +1 TOOL-SAFE 0 -- 0\n\
         {}** drum tool DRILL-2\n{INSERT}\n",
        interrupted(150)
    );
    let outcome = job("drum-filled-meanwhile", &text);
    assert_eq!(outcome.status, Some(1), "{}", outcome.last_words);
    assert!(outcome.last_words.contains(NOT_FREE), "{}", outcome.last_words);
    assert_undamaged(&outcome);
}

#[test]
fn repeated_command_finishes_an_interrupted_insertion_into_a_free_drum() {
    for ticks in [3, 60, 190, 300, 500, 700] {
        let text = format!(
            "** tray UNIT_2 1 ENDMILL-1 0 0 0\n\
             == MOVE ENDMILL-1 +1 UNIT_2 1 +1 TOOL-SAFE 0 -- 0\n\
             {}{INSERT}\n\
             ** drum grip\n\
             == RELEASE-TOOL ENDMILL-1 +1 -- 0 +1 -- 0 TOOL-SAFE 0\n",
            interrupted(ticks)
        );
        let outcome = job(&format!("drum-free-{ticks}"), &text);
        assert_eq!(outcome.status, Some(0), "{ticks}: {}", outcome.last_words);
        let mill = part(&outcome, "ENDMILL-1");
        assert_eq!(mill["location"], "TOOL-TRNS", "{ticks}: {mill}");
        assert!(mill["error_in"].as_f64().is_some_and(|error| error < 0.15), "{ticks}: {mill}");
    }
}
