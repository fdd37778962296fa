//! Emergency stops in a job: the arm sags, collisions are reported, exit status 3. A job that restarts the robot
//! continues.

use std::fs;

use record::replay;
use serde_json::Value;
use whole_system_tests::{Outcome, Scratch, run};

const STOPPED: Option<i32> = Some(3); // ended by an emergency stop

const BLANK_TO_VISE: &str = "** tray UNIT_1 4 LINKBAR1_BH\n\
     ** vise partial PFIXTURE\n\
     {stop}\
     == MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0\n";

fn job(name: &str, text: &str) -> Outcome {
    let file = format!("{name}.job");
    run(&file, 1, name, |scratch: &Scratch| {
        fs::write(scratch.file(&file), text).expect("the job can be written");
    })
}

fn touched(outcome: &Outcome) -> Vec<&str> {
    let touched = outcome.result["emergency_stop"]["touched"].as_array().expect("an emergency has a list");
    touched.iter().map(|contact| contact["obstacle"].as_str().expect("an obstacle has a name")).collect()
}

fn assert_replays(outcome: &Outcome) {
    let report = replay(&outcome.log).expect("the log can be replayed");
    if let Some(difference) = &report.first_difference {
        panic!("{difference}");
    }
    assert!(report.is_same() && report.complete);
}

fn assert_stopped(outcome: &Outcome, who: &str) {
    assert_eq!(outcome.status, STOPPED, "{}", outcome.last_words);
    let stop = &outcome.result["emergency_stop"];
    assert!(stop["cause"].as_str().is_some_and(|cause| cause.contains(who)), "{stop}");
    assert_eq!(stop["at_rest"], true, "{stop}");
    assert!(outcome.last_words.contains(who) && outcome.last_words.contains("with the hand at ("));
    let failure = &outcome.result["failure"];
    assert_eq!(
        (&failure["tick"], failure["kind"].as_str()),
        (&stop["tick"], Some("emergency-stop")),
        "{failure}"
    );
    crate::faults::assert_same_account(who, outcome);
    assert_eq!(outcome.result["allocations_after_start"], 0, "also on the way of the error");
    assert_replays(outcome);
}

/// Ticks before the end of the move into the vise.
fn before_the_end_of_the_move(ticks: u64) -> u64 {
    let whole = job("whole", &BLANK_TO_VISE.replace("{stop}", ""));
    assert_eq!(whole.status, Some(0), "{}", whole.last_words);
    let commands = whole.result["commands"].as_array().expect("a result has commands");
    commands.last().and_then(|command| command["ticks"].as_u64()).expect("a command has ticks") - ticks
}

#[test]
fn over_the_vise_the_arm_runs_into_it() {
    // The stop is one second before the blank is in the vise.
    let stop = format!("** after {} estop joystick-box\n", before_the_end_of_the_move(25));
    let outcome = job("vise", &BLANK_TO_VISE.replace("{stop}", &stop));
    assert_stopped(&outcome, "the E-stop on the joystick box was pressed");
    let hit = touched(&outcome);
    assert!(hit.iter().any(|name| name.ends_with("_jaw") || *name == "vise_body"), "{hit:?}");
    assert!(outcome.last_words.contains("has run into things: "), "{}", outcome.last_words);
}

#[test]
fn in_front_of_the_vise_the_arm_sinks_and_keeps_the_part() {
    // Only the fingers hold the blank. Later the jaws catch it as well, and pull it out.
    let stop = format!("** after {} estop joystick-box\n", before_the_end_of_the_move(100));
    let outcome = job("kept", &BLANK_TO_VISE.replace("{stop}", &stop));
    assert_stopped(&outcome, "the E-stop on the joystick box was pressed");
    assert!(touched(&outcome).contains(&"machine_pallet"), "{:?}", touched(&outcome));
    assert_eq!(outcome.part("LINKBAR1_BH")["held"], true, "air remains");
}

#[test]
fn a_sagging_arm_at_home_and_safe_hits_no_body() {
    for place in ["HOME", "SAFE"] {
        // A stop after the last command still ends the job.
        let text = format!("== MOVE -- +0 -- 0 +0 {place} 0 -- 0\n** estop pedestal\n** wait 10\n");
        let outcome = job(place, &text);
        assert_stopped(&outcome, "the E-stop near the pedestal was pressed");
        assert_eq!(touched(&outcome), [] as [&str; 0], "{place}");
        assert_eq!(outcome.result["emergency_stop"]["on_shot_pin"], true);
        assert!(outcome.last_words.contains("has touched nothing"), "{}", outcome.last_words);
    }
}

/// An emergency stop in a move, and the start-up of IV.3.3.
const RESTART: &str = "** after 60 estop terminals\n\
     == MOVE -- +0 -- 0 +0 SAFE 0 -- 0\n\
     ** wait 100\n\
     ** release terminals\n\
     ** panel fault-reset\n\
     ** panel hydraulics enable\n\
     ** panel manual on\n\
     ** panel align\n\
     ** panel auto\n\
     ** panel cycle-start\n\
     ** wait 25\n";

const PAUSE: &str = "== PAUSE -- +0 -- 0 +0 -- 0 -- 0\n"; // restarts the link, and finds the robot's place

#[test]
fn a_job_that_restarts_the_robot_continues() {
    let text =
        format!("{RESTART}{PAUSE}== MOVE -- +0 -- 0 +0 SAFE 0 -- 0\n== MOVE -- +0 -- 0 +0 HOME 0 -- 0\n");
    let outcome = job("restart", &text);
    assert_eq!(outcome.status, Some(0), "{}", outcome.last_words);
    let commands = outcome.result["commands"].as_array().expect("a result has commands");
    let states: Vec<&Value> = commands.iter().map(|command| &command["status"]).collect();
    assert_eq!(states, ["finished", "error", "finished", "finished", "finished"], "{commands:?}");
    let stop = &outcome.result["emergency_stop"];
    assert!(stop["cause"].as_str().is_some_and(|cause| cause.contains("terminals")), "{stop}");
    assert!(outcome.result.get("failure").is_none());
    assert_replays(&outcome);
}

#[test]
fn without_the_last_keys_the_next_command_finds_no_link() {
    let half: String = RESTART.lines().take(7).map(|line| format!("{line}\n")).collect();
    let outcome = job("half", &format!("{half}{PAUSE}== MOVE -- +0 -- 0 +0 HOME 0 -- 0\n"));
    assert_eq!(outcome.status, STOPPED, "{}", outcome.last_words);
    assert!(outcome.result["failure"]["process"].is_string());
}

#[test]
fn the_first_run_after_a_stop_is_unaffected() {
    let stopped = job("stopped", "** estop control-panel\n== MOVE -- +0 -- 0 +0 SAFE 0 -- 0\n");
    assert_stopped(&stopped, "control panel");
    let next = job("next", "== MOVE -- +0 -- 0 +0 SAFE 0 -- 0\n");
    assert_eq!(next.status, Some(0), "{}", next.last_words);
    assert!(next.result.get("emergency_stop").is_none());
}
