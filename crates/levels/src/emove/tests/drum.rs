use geometry::frame::{Frame, Vector};
use interfaces::{
    Reason, StatusReport, Unconfirmed,
    emove::EmoveVerb::{self, AcquireTool, InsertTool, MovToLoc, Release, ReleaseTool, RemoveTool},
    grip::Felt,
    jaws::JawsReport,
    prim::PrimReport,
    process::Process,
};

use taskdata::files::Index;

use super::{
    bench::{Bench, DONE, PAUSE, error, frame_of, moved},
    doubles::DeliveryFault,
};
use crate::{
    emove::tables::{
        AtDrum,
        drum::{AtTheDrum, DrumDecision, EmoveTool, drum},
    },
    execution::Outcome,
};

pub const SCENARIOS: &[fn()] = &[
    tool_is_inserted_and_released,
    tool_is_acquired_and_removed,
    robot_does_not_leave_the_drum_with_an_inserted_tool,
    tool_commands_without_their_preconditions_are_refused,
    gripper_failure_ends_the_tool_command,
    interrupted_insertion_resumes,
    interrupted_tool_release_resumes,
    interrupted_acquisition_resumes,
    acquire_tool_at_an_empty_drum_fails_and_release_tool_moves_out,
    contact_before_the_drum_is_reported_as_occupied_drum,
    insert_tool_requires_a_calibration_at_tool_safe,
    slide_after_a_loss_of_power_calibrates_the_sensor,
    tool_commands_refuse_an_unknown_object,
    robot_moved_away_from_the_drum_clears_the_tool_command,
];

const INSERTION: &[&str] =
    &["CAL-SENSOR", "DELTA-MOVE INS-FAR", "GO-WHILE INS-NEAR INS-ANY", "GO-WHILE INS-IN INS-FX"];

pub const SIZE: i32 = 248; // size of the tool, 0.01 in

fn run(bench: &mut Bench, verb: EmoveVerb) -> (StatusReport, Reason) {
    bench.run(verb, "CUTTER", 1, "TOOL-TRNS", 3)
}

fn loaded() -> Bench {
    let mut bench = Bench::ready("TOOL-SAFE", 3);
    bench.hold("CUTTER", SIZE, 3);
    bench
}

fn inserted() -> Bench {
    let mut bench = loaded();
    assert_eq!(run(&mut bench, InsertTool), DONE);
    bench
}

fn empty() -> Bench {
    let mut bench = Bench::ready("TOOL-SAFE", 3);
    bench.world.v_grip.opening = 350;
    bench
}

/// ACQUIRE-TOOL; the slide brings the tool between the fingers.
fn acquire(bench: &mut Bench) -> (StatusReport, Reason) {
    bench.world.log.clear();
    bench.command(AcquireTool, "CUTTER", 1, "TOOL-TRNS", 3);
    bench.until_logged("GO-UNTIL ACQ-SLIDE ACQ-MY");
    bench.world.object = Some(SIZE);
    bench.finish()
}

#[test]
fn tool_is_inserted_and_released() {
    let mut bench = loaded();
    assert_eq!(run(&mut bench, InsertTool), DONE);
    assert_eq!(bench.log(), INSERTION);
    assert!(bench.off(&moved(frame_of("TOOL-TRNS"), &["INS-IN"])) < 0.02);
    assert_eq!(bench.at(), "TOOL-TRNS");
    assert_eq!(run(&mut bench, InsertTool), DONE, "the tool is in the drum");
    assert!(bench.log().is_empty());
    assert_eq!(run(&mut bench, ReleaseTool), DONE);
    assert_eq!(
        bench.log(),
        ["RELEASE 400", "CAL-SENSOR", "GO-UNTIL REL-SLIDE REL-MY", "DELTA-MOVE REL-BACK"]
    );
    assert!(bench.off(&moved(frame_of("TOOL-TRNS"), &["INS-IN", "REL-SLIDE", "REL-BACK"])) < 0.02);
    assert!(!bench.memory.emove.status.held.is_held());
    assert_eq!(run(&mut bench, ReleaseTool), DONE, "the tool is released");
    assert!(bench.log().is_empty());
    assert_eq!(bench.run(MovToLoc, "", 0, "TOOL-SAFE", 0), DONE);
}

#[test]
fn tool_is_acquired_and_removed() {
    let mut bench = empty();
    assert_eq!(acquire(&mut bench), DONE);
    assert_eq!(
        bench.log(),
        ["POSE 400", "DELTA-MOVE ACQ-NEAR", "CAL-SENSOR", "GO-UNTIL ACQ-STRIKE ACQ-FX", "CAL-SENSOR"]
            .into_iter()
            .chain(["GO-UNTIL ACQ-SLIDE ACQ-MY", "GRASP 250"])
            .collect::<Vec<_>>()
    );
    assert!(bench.off(&moved(frame_of("TOOL-TRNS"), &["ACQ-STRIKE", "ACQ-SLIDE"])) < 0.02);
    assert_eq!(bench.held(), "CUTTER");
    assert_eq!(run(&mut bench, AcquireTool), DONE, "the tool is held");
    assert!(bench.log().is_empty());
    assert_eq!(run(&mut bench, RemoveTool), DONE);
    assert_eq!(bench.log(), ["CAL-SENSOR", "GO-WHILE REM-OUT REM-FX"]);
    assert_eq!(run(&mut bench, RemoveTool), DONE, "the tool is out");
    assert!(bench.log().is_empty());
    assert_eq!(bench.run(MovToLoc, "", 0, "TOOL-SAFE", 0), DONE);
    assert!(bench.memory.emove.status.held.is_held());
}

#[test]
fn robot_does_not_leave_the_drum_with_an_inserted_tool() {
    let mut bench = inserted();
    assert_eq!(bench.run(MovToLoc, "", 0, "TOOL-SAFE", 0), error(Reason::NotPrepared));
    assert_eq!(run(&mut bench, ReleaseTool), DONE);
    let mut bench = inserted();
    assert_eq!(bench.run(Release, "CUTTER", 1, "", 3), DONE, "the fingers are open and around the tool");
    bench.world.object = Some(SIZE);
    assert_eq!(run(&mut bench, AcquireTool), DONE);
    assert_eq!(bench.log(), ["GRASP 250"]);
}

#[test]
fn tool_commands_without_their_preconditions_are_refused() {
    let mut bench = Bench::ready("TOOL-SAFE", 3);
    assert_eq!(run(&mut bench, InsertTool), error(Reason::NothingHeld));
    assert_eq!(run(&mut bench, ReleaseTool), error(Reason::NotPrepared), "the robot is elsewhere");
    assert_eq!(run(&mut bench, RemoveTool), error(Reason::NothingHeld));
    let mut bench = loaded();
    assert_eq!(run(&mut bench, RemoveTool), error(Reason::NotPrepared), "the tool is not in the drum");
    assert_eq!(run(&mut bench, AcquireTool), error(Reason::NotPrepared), "the tool is held outside the drum");
    let mut bench = Bench::ready("TOOL-SAFE", 3);
    bench.world.object = Some(248);
    assert_eq!(bench.run(EmoveVerb::GraspObj, "CUTTER", 1, "", 3), DONE);
    assert_eq!(bench.run(AcquireTool, "PIN", 1, "TOOL-TRNS", 3), error(Reason::AlreadyHolding));
    assert_eq!(bench.run(InsertTool, "PIN", 1, "TOOL-TRNS", 3), error(Reason::NothingHeld));
    // At the drum, a release with closed fingers, or with a tool outside its place, is unsafe.
    let mut bench = Bench::ready("TOOL-SAFE", 3);
    assert_eq!(run(&mut bench, ReleaseTool), error(Reason::NotPrepared));
    bench.hold("CUTTER", SIZE, 3);
    assert_eq!(run(&mut bench, ReleaseTool), error(Reason::NotPrepared));
    for verb in [InsertTool, ReleaseTool, AcquireTool, RemoveTool] {
        let mut bench = loaded();
        assert_eq!(bench.run(verb, "CUTTER", 1, "HOME", 3), error(Reason::NoRelativeMove), "{verb}");
        bench.world.frame = moved(frame_of("HOME"), &["300ty"]);
        bench.wait(3);
        assert_eq!(run(&mut bench, verb), error(Reason::UnknownStart), "{verb}");
    }
    let mut bench = loaded();
    bench.data.indexes.sensors = Index::default();
    assert_eq!(
        run(&mut bench, InsertTool),
        error(Reason::UnknownSensor),
        "the task data name no sensor for a guarded move"
    );
    let mut bench = empty();
    assert_eq!(bench.run(AcquireTool, "CUTTER", 9, "TOOL-TRNS", 3), error(Reason::UnknownGrip));
}

#[test]
fn unexpected_force_stops_the_tool_command() {
    let detected = DeliveryFault::Prim(PrimReport::DetectedErr, Reason::Detected);
    let mut bench = loaded();
    bench.spoil("INS-IN", detected);
    assert_eq!(run(&mut bench, InsertTool), error(Reason::Detected));
    assert!(bench.memory.emove.status.held.is_held() && bench.memory.emove.status.at.is_none());
    let mut bench = empty();
    assert_eq!(acquire(&mut bench), DONE);
    bench.spoil("REM-OUT", detected);
    assert_eq!(run(&mut bench, RemoveTool), error(Reason::Detected));
}

#[test]
fn missing_contact_fails_the_tool_command() {
    let missed = DeliveryFault::Prim(PrimReport::NotDetected, Reason::NotDetected);
    let mut bench = inserted();
    bench.spoil("REL-SLIDE", missed);
    assert_eq!(run(&mut bench, ReleaseTool), error(Reason::NotDetected));
    for word in ["ACQ-STRIKE", "ACQ-SLIDE"] {
        let mut bench = empty();
        bench.spoil(word, missed);
        assert_eq!(run(&mut bench, AcquireTool), error(Reason::NotDetected), "{word}");
        bench.step();
        assert_eq!(bench.log().last(), Some(&"PAUSE"));
    }
}

#[test]
fn slipping_tool_is_reported_as_lost() {
    for (verb, before) in [(InsertTool, None), (RemoveTool, Some(()))] {
        let mut bench = if before.is_none() { loaded() } else { inserted() };
        bench.command(verb, "CUTTER", 1, "TOOL-TRNS", 3);
        bench.wait(4);
        bench.world.tool_grip.opening = 100;
        assert_eq!(bench.finish(), error(Reason::ObjectLost), "{verb}");
    }
    let mut bench = empty();
    assert_eq!(run(&mut bench, AcquireTool), error(Reason::NoToolInDrum), "the drum is empty");
}

#[test]
fn acquire_tool_at_an_empty_drum_fails_and_release_tool_moves_out() {
    let mut bench = empty();
    assert_eq!(run(&mut bench, AcquireTool), error(Reason::NoToolInDrum));
    assert_eq!(run(&mut bench, AcquireTool), error(Reason::NoToolInDrum), "sent again");
    assert_eq!(bench.run(MovToLoc, "", 0, "TOOL-SAFE", 0), error(Reason::InDrum));
    assert_eq!(run(&mut bench, ReleaseTool), DONE);
    assert_eq!(bench.run(MovToLoc, "", 0, "TOOL-SAFE", 0), DONE);
    assert_eq!(acquire(&mut bench), DONE, "a tool has been put into the drum");
}

fn orders(bench: &Bench) -> Vec<&str> {
    bench.log().into_iter().filter(|order| *order != "PAUSE").collect()
}

#[test]
fn contact_before_the_drum_is_reported_as_occupied_drum() {
    let detected = DeliveryFault::Prim(PrimReport::DetectedErr, Reason::Detected);
    let mut bench = loaded();
    bench.spoil("INS-NEAR", detected);
    assert_eq!(run(&mut bench, InsertTool), error(Reason::DrumOccupied));
    assert_eq!(orders(&bench), INSERTION[..3]);
    assert!(bench.memory.emove.status.held.is_held());
    // Sent again, the command returns to a place without contact, and does not calibrate during contact.
    assert_eq!(run(&mut bench, InsertTool), error(Reason::DrumOccupied));
    assert_eq!(orders(&bench), INSERTION[1..3]);
    bench.world.mishaps.clear();
    assert_eq!(run(&mut bench, InsertTool), DONE, "the drum has been emptied");
    assert_eq!(orders(&bench), &INSERTION[1..]);
    // REMOVE-TOOL also leads away.
    let mut bench = loaded();
    bench.spoil("INS-NEAR", detected);
    assert_eq!(run(&mut bench, InsertTool), error(Reason::DrumOccupied));
    assert_eq!(run(&mut bench, RemoveTool), DONE);
    assert_eq!(bench.run(MovToLoc, "", 0, "TOOL-SAFE", 0), DONE);
    // A sensor failure on the way does not mean that the drum is occupied.
    let mut bench = loaded();
    bench.spoil("INS-NEAR", DeliveryFault::Prim(PrimReport::SensorError, Reason::SensorError));
    assert_eq!(run(&mut bench, InsertTool), error(Reason::SensorError));
}

#[test]
fn insert_tool_requires_a_calibration_at_tool_safe() {
    let refused = error(Reason::ForceUncalibrated);
    for (word, frame) in [("INS-NEAR", at(-3.0, 0.0)), ("INS-IN", at(-1.0, 0.0)), ("INS-IN", at(-0.1, 0.0))] {
        let mut bench = loaded();
        interrupt(&mut bench, InsertTool, word, frame);
        bench.world.prim.calibrated = false;
        assert_eq!(run(&mut bench, InsertTool), refused, "{word}: the sensor has lost its power");
        assert!(orders(&bench).is_empty(), "{:?}", bench.log());
        assert_eq!(run(&mut bench, RemoveTool), DONE, "{word}");
        assert_eq!(bench.run(MovToLoc, "", 0, "TOOL-SAFE", 0), DONE);
        assert_eq!(run(&mut bench, InsertTool), DONE, "{word}");
        assert_eq!(bench.log(), INSERTION, "{word}");
    }
    // REMOVE-TOOL at once, from before the drum, keeps the calibration of TOOL-SAFE.
    let mut bench = loaded();
    interrupt(&mut bench, InsertTool, "INS-NEAR", at(-3.0, 0.0));
    assert_eq!(run(&mut bench, RemoveTool), DONE);
    assert_eq!(run(&mut bench, InsertTool), DONE);
    assert_eq!(bench.log(), &INSERTION[1..]);
    // REMOVE-TOOL calibrates the sensor at the drum.
    let mut bench = inserted();
    assert_eq!(run(&mut bench, RemoveTool), DONE);
    assert_eq!(run(&mut bench, InsertTool), refused, "the robot is before the drum");
    let mut bench = inserted();
    interrupt(&mut bench, RemoveTool, "REM-OUT", at(-3.0, 0.0));
    assert_eq!(run(&mut bench, InsertTool), refused, "the robot is on its way out");
    // A restart of E-move keeps the place of the calibration.
    let mut bench = loaded();
    interrupt(&mut bench, InsertTool, "INS-NEAR", at(-3.0, 0.0));
    bench.restart();
    bench.wait(2);
    assert_eq!(run(&mut bench, InsertTool), DONE);
    assert_eq!(bench.log(), &INSERTION[1..]);
}

#[test]
fn gripper_failure_ends_the_tool_command() {
    let mut bench = inserted();
    bench.spoil("RELEASE", DeliveryFault::Jaws(JawsReport::Stuck));
    assert_eq!(run(&mut bench, ReleaseTool), error(Reason::JawsStuck));
    // A partly released tool is neither pulled out nor done.
    bench.world.mishaps.clear();
    bench.world.log.clear();
    for verb in [InsertTool, RemoveTool] {
        assert_eq!(run(&mut bench, verb), error(Reason::ReleaseNotEnded), "{verb}");
    }
    assert!(bench.log().iter().all(|word| *word == "PAUSE"), "{:?}", bench.log());
    // The tool is grasped again.
    bench.world.tool_grip.opening = SIZE + 50;
    bench.world.log.clear();
    assert_eq!(run(&mut bench, AcquireTool), DONE);
    assert!(bench.log().contains(&"GRASP 250"), "{:?}", bench.log());
    for word in ["POSE", "GRASP"] {
        let mut bench = empty();
        bench.spoil(word, DeliveryFault::Jaws(JawsReport::Stuck));
        assert_eq!(run(&mut bench, AcquireTool), error(Reason::JawsStuck), "{word}");
    }
}

#[test]
fn motion_failure_ends_the_tool_command() {
    let failed = DeliveryFault::Prim(PrimReport::SensorError, Reason::SensorError);
    for (verb, words) in [
        (InsertTool, &["CAL-SENSOR", "INS-FAR", "INS-NEAR", "INS-IN"][..]),
        (ReleaseTool, &["CAL-SENSOR", "REL-SLIDE", "REL-BACK"]),
        (AcquireTool, &["ACQ-NEAR", "CAL-SENSOR", "ACQ-STRIKE", "ACQ-SLIDE"]),
        (RemoveTool, &["CAL-SENSOR", "REM-OUT"]),
    ] {
        for word in words {
            let mut bench = match verb {
                InsertTool => loaded(),
                AcquireTool => empty(),
                _ => inserted(),
            };
            bench.spoil(word, failed);
            assert_eq!(run(&mut bench, verb), error(Reason::SensorError), "{verb} {word}");
        }
    }
}

/// The place of a tool in the drum, moved into the drum by `x` and to the left by `z`, in.
fn at(x: f64, z: f64) -> Frame {
    frame_of("TOOL-TRNS").shifted(Vector::new(x, 0.0, z))
}

/// PAUSE after the order with a word, with the robot at a frame; clears the log.
fn interrupt(bench: &mut Bench, verb: EmoveVerb, word: &str, frame: Frame) {
    bench.world.log.clear();
    bench.command(verb, "CUTTER", 1, "TOOL-TRNS", 3);
    bench.until_logged(word);
    bench.world.frame = frame;
    assert_eq!(bench.execute(PAUSE), DONE);
    bench.world.log.clear();
}

#[test]
fn interrupted_insertion_resumes() {
    for (word, frame, orders) in [
        ("CAL-SENSOR", frame_of("TOOL-SAFE"), INSERTION),
        ("INS-FAR", at(-5.0, 0.0), &INSERTION[1..]),
        ("INS-NEAR", at(-3.3, 0.0), &INSERTION[1..]),
        ("INS-IN", at(-1.0, 0.0), &INSERTION[3..]),
        ("INS-IN", at(-0.25, 0.0), &INSERTION[3..]),
        ("INS-IN", at(-0.1, 0.0), &INSERTION[3..]),
    ] {
        let x = frame.position - frame_of("TOOL-TRNS").position;
        let mut bench = loaded();
        interrupt(&mut bench, InsertTool, word, frame);
        assert!(!bench.memory.emove.status.drum, "{word} {x}");
        assert_eq!(run(&mut bench, InsertTool), DONE, "{word} {x}");
        assert_eq!(bench.log(), orders, "{word} {x}");
        assert!(bench.off(&moved(frame_of("TOOL-TRNS"), &["INS-IN"])) < 0.02);
        assert!(bench.memory.emove.status.drum);
        assert_eq!(run(&mut bench, ReleaseTool), DONE);
    }
    // The insertion can be undone as well.
    let mut bench = loaded();
    interrupt(&mut bench, InsertTool, "INS-IN", at(-1.0, 0.0));
    assert_eq!(run(&mut bench, ReleaseTool), error(Reason::NotPrepared), "the tool is half in");
    assert_eq!(run(&mut bench, AcquireTool), error(Reason::NotPrepared));
    assert_eq!(run(&mut bench, RemoveTool), DONE);
    assert_eq!(bench.log().last(), Some(&"GO-WHILE REM-OUT REM-FX"));
    assert!(!bench.log().contains(&"CAL-SENSOR"), "no calibration under a force");
    assert_eq!(bench.run(MovToLoc, "", 0, "TOOL-SAFE", 0), DONE);
    let mut bench = loaded();
    interrupt(&mut bench, InsertTool, "INS-FAR", at(-5.0, 0.0));
    assert_eq!(run(&mut bench, ReleaseTool), error(Reason::NotPrepared), "the tool is not in the drum");
    assert_eq!(run(&mut bench, RemoveTool), DONE);
    assert!(!bench.log().iter().any(|order| order.contains("REM-OUT")), "the tool is out");
    // Places without a known way.
    for verb in [InsertTool, RemoveTool] {
        let mut bench = Bench::ready("HOME", 3);
        bench.hold("CUTTER", SIZE, 3);
        assert_eq!(run(&mut bench, verb), error(Reason::NotPrepared), "{verb}");
    }
}

#[test]
fn interrupted_tool_release_resumes() {
    const WHOLE: &[&str] = &["RELEASE 400", "CAL-SENSOR", "GO-UNTIL REL-SLIDE REL-MY", "DELTA-MOVE REL-BACK"];
    for (word, x, z, orders) in [
        ("RELEASE", 0.0, 0.0, WHOLE),
        ("CAL-SENSOR", 0.0, 0.0, WHOLE),
        ("REL-SLIDE", 0.0, -0.1, WHOLE),
        ("REL-SLIDE", 0.0, -1.0, &WHOLE[2..]),
        ("REL-BACK", 0.0, -1.8, &WHOLE[3..]),
        ("REL-BACK", -3.0, -1.8, &WHOLE[3..]),
    ] {
        let mut bench = inserted();
        interrupt(&mut bench, ReleaseTool, word, at(x, z));
        assert_eq!(run(&mut bench, ReleaseTool), DONE, "{word} {x} {z}");
        assert_eq!(bench.log(), orders, "{word} {x} {z}");
        let end = if orders == WHOLE { -2.0 + z } else { z.min(-2.0).max(if z < -1.5 { z } else { -2.0 }) };
        assert!(bench.off(&at(-4.99, end)) < 0.03, "{word} {x} {z}: the moves reach their original ends");
        assert!(!bench.memory.emove.status.held.is_held() && !bench.memory.emove.status.drum);
        assert_eq!(bench.run(MovToLoc, "", 0, "TOOL-SAFE", 0), DONE);
    }
    // Fingers closed since then would pull at the drum.
    for (verb, z) in [(ReleaseTool, -1.0), (AcquireTool, -1.0), (ReleaseTool, -1.8)] {
        let mut bench = inserted();
        interrupt(&mut bench, ReleaseTool, "REL-SLIDE", at(0.0, z));
        bench.world.tool_grip.opening = 100;
        assert_eq!(run(&mut bench, verb), error(Reason::NotPrepared), "{verb} {z}");
    }
    let mut bench = Bench::ready("HOME", 3);
    assert_eq!(run(&mut bench, ReleaseTool), error(Reason::NotPrepared));
}

#[test]
fn interrupted_acquisition_resumes() {
    const WHOLE: &[&str] = &[
        "POSE 400",
        "DELTA-MOVE ACQ-NEAR",
        "CAL-SENSOR",
        "GO-UNTIL ACQ-STRIKE ACQ-FX",
        "CAL-SENSOR",
        "GO-UNTIL ACQ-SLIDE ACQ-MY",
        "GRASP 250",
    ];
    for (word, x, z, orders) in [
        ("ACQ-NEAR", -3.0, -0.8, WHOLE),
        ("ACQ-NEAR", -1.0, -1.5, WHOLE),
        ("ACQ-STRIKE", 0.0, -1.65, WHOLE),
        ("ACQ-SLIDE", 0.1, -1.0, &WHOLE[5..]),
        ("ACQ-SLIDE", 0.1, 0.1, &WHOLE[6..]),
    ] {
        let mut bench = empty();
        interrupt(&mut bench, AcquireTool, word, at(x, z));
        assert_eq!(acquire_from(&mut bench), DONE, "{word} {x} {z}");
        assert_eq!(bench.log(), orders, "{word} {x} {z}");
        let end = if orders == WHOLE { at(0.25, 0.5) } else { at(x, z.max(0.5 * f64::from(z < 0.0))) };
        assert!(bench.off(&end) < 0.03, "{word} {x} {z}: the slide reaches its original end");
        assert!(bench.memory.emove.status.held.object().is_some() && bench.memory.emove.status.drum);
        assert_eq!(run(&mut bench, RemoveTool), DONE);
    }
    let mut bench = Bench::ready("HOME", 3);
    assert_eq!(run(&mut bench, AcquireTool), error(Reason::NotPrepared));
}

#[test]
fn slide_after_a_loss_of_power_calibrates_the_sensor() {
    let mut bench = inserted();
    interrupt(&mut bench, ReleaseTool, "REL-SLIDE", at(0.0, -1.0));
    bench.world.prim.calibrated = false;
    assert_eq!(run(&mut bench, ReleaseTool), DONE);
    assert_eq!(bench.log(), ["CAL-SENSOR", "GO-UNTIL REL-SLIDE REL-MY", "DELTA-MOVE REL-BACK"]);
    let mut bench = empty();
    interrupt(&mut bench, AcquireTool, "ACQ-SLIDE", at(0.1, -1.0));
    bench.world.prim.calibrated = false;
    assert_eq!(acquire_from(&mut bench), DONE);
    assert_eq!(bench.log(), ["CAL-SENSOR", "GO-UNTIL ACQ-SLIDE ACQ-MY", "GRASP 250"]);
    // Closed fingers may touch the tool.
    let mut bench = inserted();
    interrupt(&mut bench, ReleaseTool, "REL-SLIDE", at(0.0, -1.0));
    (bench.world.prim.calibrated, bench.world.tool_grip.opening) = (false, 100);
    assert_eq!(run(&mut bench, ReleaseTool), error(Reason::NotPrepared));
    assert!(orders(&bench).is_empty(), "{:?}", bench.log());
    // A calibration that has no effect is not repeated.
    let mut bench = inserted();
    interrupt(&mut bench, ReleaseTool, "REL-SLIDE", at(0.0, -1.0));
    bench.world.prim.calibrated = false;
    bench.spoil("CAL-SENSOR", DeliveryFault::Prim(PrimReport::SensorError, Reason::SensorError));
    assert_eq!(run(&mut bench, ReleaseTool), error(Reason::SensorError));
}

/// ACQUIRE-TOOL sent again; the tool is between the fingers before they close.
fn acquire_from(bench: &mut Bench) -> (StatusReport, Reason) {
    bench.world.log.clear();
    bench.command(AcquireTool, "CUTTER", 1, "TOOL-TRNS", 3);
    bench.until_logged("GRASP 250");
    bench.world.object = Some(SIZE);
    bench.finish()
}

#[test]
fn interrupted_removal_resumes() {
    for (word, x, orders) in [
        ("CAL-SENSOR", 0.0, &["CAL-SENSOR", "GO-WHILE REM-OUT REM-FX"][..]),
        ("REM-OUT", -0.1, &["GO-WHILE REM-OUT REM-FX"]),
        ("REM-OUT", -0.25, &["GO-WHILE REM-OUT REM-FX"]),
        ("REM-OUT", -1.0, &["GO-WHILE REM-OUT REM-FX"]),
        ("REM-OUT", -3.0, &[]),
    ] {
        let mut bench = inserted();
        interrupt(&mut bench, RemoveTool, word, at(x, 0.0));
        assert_eq!(run(&mut bench, RemoveTool), DONE, "{word} {x}");
        assert_eq!(bench.log(), orders, "{word} {x}");
        let end = if orders.is_empty() { x } else { -6.0 };
        assert!(bench.off(&at(end, 0.0)) < 0.03, "{word} {x}: the move reaches its original end");
        assert!(bench.memory.emove.status.held.is_held() && !bench.memory.emove.status.drum);
        assert_eq!(bench.run(MovToLoc, "", 0, "TOOL-SAFE", 0), DONE);
    }
    // The tool can also return into the drum.
    let mut bench = inserted();
    interrupt(&mut bench, RemoveTool, "REM-OUT", at(-0.5, 0.0));
    assert_eq!(run(&mut bench, InsertTool), DONE);
    assert_eq!(bench.log(), ["GO-WHILE INS-IN INS-FX"]);
}

#[test]
fn robot_in_the_drum_refuses_other_commands() {
    let mut bench = loaded();
    interrupt(&mut bench, InsertTool, "INS-IN", at(-1.0, 0.0));
    for verb in [MovToLoc, EmoveVerb::Withdraw] {
        assert_eq!(bench.run(verb, "", 0, "BENCH", 0), error(Reason::InDrum), "{verb}");
    }
    assert_eq!(bench.run(EmoveVerb::QcDetach, "GRIPPER-3", 1, "HOLSTER-C", 3), error(Reason::InDrum));
    assert_eq!(run(&mut bench, InsertTool), DONE);
}

#[test]
fn insertion_resumes_after_manual_motion_away_and_back() {
    let mut bench = loaded();
    interrupt(&mut bench, InsertTool, "INS-IN", at(-1.0, 0.0));
    bench.lead(|bench| {
        bench.world.frame = at(-20.0, 0.0);
        bench.wait(3);
        bench.world.frame = at(-1.0, 0.0);
    });
    assert_eq!(bench.pause(), DONE);
    assert_eq!(run(&mut bench, InsertTool), DONE);
}

#[test]
fn tool_acquired_after_manual_motion_has_an_unconfirmed_seat() {
    for (led, unconfirmed) in [(false, Unconfirmed::GraspForce), (true, Unconfirmed::PartInFingers)] {
        let mut bench = empty();
        interrupt(&mut bench, AcquireTool, "ACQ-SLIDE", moved(frame_of("TOOL-TRNS"), &["ACQ-STRIKE"]));
        bench.world.joystick = led;
        bench.wait(5);
        bench.world.joystick = false;
        assert_eq!(bench.pause(), DONE);
        bench.world.log.clear();
        bench.command(AcquireTool, "CUTTER", 1, "TOOL-TRNS", 3);
        bench.until_logged("ACQ-SLIDE");
        bench.world.object = Some(SIZE);
        assert_eq!(bench.finish(), DONE, "led: {led}");
        assert_eq!(bench.memory.emove.status.unconfirmed, unconfirmed, "led: {led}");
    }
}

#[test]
fn robot_moved_away_from_the_drum_clears_the_tool_command() {
    for away in [at(-1.0, 3.5), at(-20.0, 0.0), at(1.0, 0.0), at(-1.0, -1.0), at(-5.0, 5.0)] {
        let mut bench = loaded();
        interrupt(&mut bench, InsertTool, "INS-IN", at(-1.0, 0.0));
        bench.world.frame = away;
        bench.wait(3);
        assert!(bench.memory.emove.estimates.drum.is_none());
        assert_eq!(run(&mut bench, InsertTool), error(Reason::UnknownStart));
    }
}

#[test]
fn tool_commands_refuse_an_unknown_object() {
    for (felt, verb, reason) in [
        (Felt::NotKnown, InsertTool, Reason::HeldNotKnown),
        (Felt::NotKnown, AcquireTool, Reason::HeldNotKnown),
        (Felt::NotKnown, RemoveTool, Reason::HeldNotKnown),
        (Felt::Something, AcquireTool, Reason::AlreadyHolding),
    ] {
        let mut bench = empty();
        bench.world.dead.push("gripper");
        bench.memory.tool_grip.status.felt = felt;
        let state = bench.process.state_mut();
        state.adopt(&interfaces::emove::Estimates { empty: false, ..state.estimates() });
        assert_eq!(run(&mut bench, verb), error(reason), "{verb}");
    }
}

#[test]
fn drum_table_decides_the_interrupted_tool_command() {
    let row = |at, tool, outcome| {
        let decision = drum((), &AtTheDrum { at, tool, outcome });
        (decision.row, decision.action)
    };
    for outcome in [Outcome::Idle, Outcome::Done, Outcome::Error, Outcome::Joystick] {
        assert_eq!(row(AtDrum::Off, EmoveTool::Grasped, outcome), (1, DrumDecision::Leave));
        assert_eq!(row(AtDrum::Inside, EmoveTool::Grasped, outcome), (2, DrumDecision::Stand));
        assert_eq!(row(AtDrum::Inside, EmoveTool::Loose, outcome), (4, DrumDecision::Keep));
    }
    assert_eq!(row(AtDrum::Inside, EmoveTool::Grasped, Outcome::Executing), (3, DrumDecision::Keep));
    for at in [AtDrum::Before, AtDrum::Entering, AtDrum::Sliding, AtDrum::Clear] {
        assert_eq!(row(at, EmoveTool::Grasped, Outcome::Done), (5, DrumDecision::Keep));
    }
}
