//! The first command after a motion by hand: it ends at its goal, or is refused with the distance
//! (docs/design/recovery.md "Return").

use std::fs;

use geometry::{frame::Frame, pose::Pose};
use interfaces::{CommonMemory, Reason};
use rcs_core::plain::from_bytes;
use record::Log;
use whole_system_tests::{Outcome, Scratch, run};

/// HOME-POS (Figure VII.1).
const HOME: Pose = Pose { wrist: [0, -5022, 636], tool: [0, -7145, -1483], finger: [3000, -7145, -1483] };
const TO_HOME: &str = "== MOVE -- +0 -- 0 +0 HOME 0 -- 0\n";

fn jog(moves: &[&str]) -> String {
    let mut lines = "** joystick velocity 500\n".to_owned();
    for line in moves {
        lines += &format!("** joystick {line}\n** wait 20\n");
    }
    lines + "** joystick frame OFF\n** wait 15\n** joystick velocity 1000\n"
}

fn job(name: &str, text: &str) -> Outcome {
    let file = format!("{name}.job");
    run(&file, 1, name, |scratch: &Scratch| {
        fs::write(scratch.file(&file), text).expect("the job can be written");
    })
}

fn hand(outcome: &Outcome) -> Frame {
    let log = Log::open(&outcome.log).expect("the log can be read");
    let last = log.ticks().last().expect("a run has ticks").expect("a sound tick");
    let memory: CommonMemory = from_bytes(&last.memory).expect("sound buffers");
    let pose = memory.prim.status.sensor_pose.and_then(|number| memory.changing_pose(number));
    pose.expect("the resolvers give a pose").to_frame().expect("a pose is a frame")
}

fn assert_at_home(outcome: &Outcome) {
    assert_eq!(outcome.status, Some(0), "{}", outcome.last_words);
    let off = hand(outcome).distance(&HOME.to_frame().unwrap());
    assert!(off.inches <= 0.02 && off.radians.to_degrees() <= 0.1, "{off:?}");
    assert_eq!(outcome.result["contacts"], serde_json::json!([]));
}

#[test]
fn a_short_jog_is_undone_by_the_move_to_the_same_place() {
    for (stick, ticks) in [("100 0", 50), ("0 -60", 30), ("0 200", 30)] {
        let moved = jog(&["frame WORLD", &format!("stick {stick} {ticks}")]);
        assert_at_home(&job("short-jog", &(TO_HOME.to_owned() + &moved + TO_HOME)));
    }
}

#[test]
fn a_long_jog_is_undone_by_the_move_to_the_same_place() {
    let moved = jog(&["frame WORLD", "stick 1000 0 50"]);
    assert_at_home(&job("long-jog", &(TO_HOME.to_owned() + &moved + TO_HOME)));
    // Two jogs in several frames, with rotations.
    let first = jog(&["frame WORLD", "stick 0 700 40", "frame OFF", "frame TOOL", "stick -500 500 30"]);
    let second =
        jog(&["frame TOOL-ORIGIN", "stick 500 0 20", "frame OFF", "frame WRIST-ORIGIN", "stick 0 600 20"]);
    assert_at_home(&job("jogs", &(TO_HOME.to_owned() + &first + &second + TO_HOME)));
    let back = jog(&["frame WORLD", "stick 1000 0 50", "stick -1000 0 47"]); // away and back by hand
    assert_at_home(&job("back", &(TO_HOME.to_owned() + &back + TO_HOME)));
}

#[test]
fn a_jog_out_of_an_interrupted_move_is_undone_by_the_same_command() {
    for stick in ["100 100", "1000 300", "-1000 0"] {
        let text = format!(
            "== MOVE -- +0 -- 0 +0 SAFE 0 -- 0\n\
             ** after 60 joystick velocity 500\n\
             ** after 60 joystick frame WORLD\n\
             ** after 70 joystick stick {stick} 60\n\
             ** after 160 joystick frame OFF\n\
             == MOVE -- +0 -- 0 +0 HOME 0 -- 0 expect error\n\
             ** wait 120\n\
             ** joystick velocity 1000\n{TO_HOME}"
        );
        assert_at_home(&job("interrupted", &text));
    }
}

#[test]
fn unrecorded_jog_ends_straight_at_a_resting_place() {
    let hold = jog(&[
        "frame WORLD",
        "stick 500 0 20",
        "hold EMOVE",
        "stick 500 0 40",
        "free EMOVE",
        "stick 0 500 20",
    ]);
    let outcome = job("broken", &(TO_HOME.to_owned() + &hold + TO_HOME));
    assert_at_home(&outcome);
    // From too far away the command is refused, and the message states the distance.
    let far = jog(&["frame WORLD", "stick 500 0 20", "hold EMOVE", "stick 1000 0 150", "free EMOVE"]);
    let outcome = job("far", &(TO_HOME.to_owned() + &far + TO_HOME));
    let said = &outcome.last_words;
    assert_eq!(outcome.status, Some(1), "{said}");
    assert!(
        said.contains(Reason::UnknownStart.text()) && said.contains("HOME is 1") && said.contains("(-X 1"),
        "{said}"
    );
}

#[test]
fn a_part_moved_off_its_sector_is_released_in_it() {
    for moves in [&["frame WORLD", "up 12"][..], &["frame WORLD", "up 80"]] {
        let text = format!(
            "** tray UNIT_1 4 LINKBAR1_BH\n\
             == MOVE LINKBAR1_BH +2 UNIT_1 4 +2 UNIT_1 1 -- 0\n{}\
             == TRANSFER LINKBAR1_BH +2 UNIT_1 4 +2 UNIT_1 1 HOME 0\n",
            jog(moves)
        );
        let outcome = job("sector", &text);
        assert_at_home(&outcome);
        let part = outcome.part("LINKBAR1_BH");
        assert_eq!((&part["location"], &part["sector"]), (&"UNIT_1".into(), &1.into()), "{part}");
        assert!(part["error_in"].as_f64().is_some_and(|error| error < 0.05), "{part}");
    }
}

#[test]
fn a_part_in_the_vise_is_released_only_at_its_destination() {
    let begin = "** tray UNIT_1 4 LINKBAR1_BH\n** vise partial PFIXTURE\n\
                 == MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0\n** vise close PFIXTURE\n";
    let away = jog(&["frame WORLD", "stick 0 100 40"]);
    // The joystick box took control in the first five ticks of this motion.
    let back = jog(&["frame WORLD", "stick 0 -100 35"]);
    let position = "== POSITION H-LINKBAR1_BH +1 PFIXTURE 0 +0 -- 0 -- 0\n";
    let again = position.replace('\n', " expect error\n");
    let outcome = job("vise", &format!("{begin}{away}{again}{back}{position}"));
    assert_eq!(outcome.status, Some(0), "{}", outcome.last_words);
    let outcome = job("off-vise", &format!("{begin}{away}{position}"));
    let said = &outcome.last_words;
    assert_eq!(outcome.status, Some(1), "{said}");
    assert!(said.contains(Reason::OffPlace.text()) && said.contains("PFIXTURE is 0."), "{said}");
}

#[test]
fn a_jog_in_a_holster_leaves_only_the_gripper_change() {
    // The gripper change begins at about the 700th tick.
    let text = format!(
        "** tray UNIT_2 7 SHAFT_BH 0 0 0\n\
         ** after 700 joystick velocity 500\n\
         ** after 700 joystick frame WORLD\n\
         ** after 710 joystick stick 100 0 20\n\
         ** after 760 joystick frame OFF\n\
         == TRANSFER SHAFT_BH +1 UNIT_2 7 +1 V-VFIXTURE 0 HOME 0 expect error\n\
         ** wait 100\n{TO_HOME}"
    );
    let outcome = job("holster", &text);
    assert_eq!(outcome.status, Some(1), "{}", outcome.last_words);
    assert!(outcome.last_words.contains(Reason::InHolster.text()), "{}", outcome.last_words);
}
