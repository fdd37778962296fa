//! INSERT-TOOL, RELEASE-TOOL, ACQUIRE-TOOL and REMOVE-TOOL.

use rcs_core::interface::{
    Reason, Report,
    emove::EmoveVerb::{self, AcquireTool, InsertTool, MovToLoc, Release, ReleaseTool, RemoveTool},
    jaws::JawsReport,
    prim::PrimReport,
};

use taskdata::files::Index;

use super::{
    bench::{Bench, DONE, error, frame_of, moved},
    doubles::Mishap,
};

pub const SCENARIOS: &[fn()] = &[
    a_tool_is_put_into_the_drum_and_left,
    a_tool_is_taken_out_of_the_drum,
    a_tool_in_the_drum_is_not_dragged_away,
    tool_commands_begin_only_when_they_can,
    a_force_that_must_not_come_stops_the_robot,
    a_contact_that_does_not_come_is_given_up,
    a_tool_that_slips_is_noticed,
    a_failing_gripper_ends_the_command,
    a_failing_motion_ends_the_command,
];

/// Size of the tool, 0.01 in.
const SIZE: i32 = 248;

fn run(bench: &mut Bench, verb: EmoveVerb) -> (Report, Reason) {
    bench.run(verb, "CUTTER", 1, "TOOL-TRNS", 3)
}

/// A robot before the drum, with a tool.
fn loaded() -> Bench {
    let mut bench = Bench::ready("TOOL-SAFE", 3);
    bench.hold("CUTTER", SIZE, 3);
    bench
}

/// A robot whose tool is in the drum.
fn inserted() -> Bench {
    let mut bench = loaded();
    assert_eq!(run(&mut bench, InsertTool), DONE);
    bench
}

/// A robot before the drum with open fingers, and a tool in it.
fn empty() -> Bench {
    let mut bench = Bench::ready("TOOL-SAFE", 3);
    bench.v_grip.opening = 350;
    bench
}

/// ACQUIRE-TOOL with a tool that comes between the fingers by the slide.
fn acquire(bench: &mut Bench) -> (Report, Reason) {
    bench.world.log.clear();
    bench.command(AcquireTool, "CUTTER", 1, "TOOL-TRNS", 3);
    while !bench.log().contains(&"GO-UNTIL ACQ-SLIDE ACQ-MY") {
        bench.step();
    }
    bench.world.object = Some(SIZE);
    bench.finish()
}

#[test]
fn a_tool_is_put_into_the_drum_and_left() {
    let mut bench = loaded();
    assert_eq!(run(&mut bench, InsertTool), DONE);
    assert_eq!(bench.log(), ["DELTA-MOVE INS-NEAR", "CAL-SENSOR", "GO-WHILE INS-IN INS-FX"]);
    assert!(bench.off(&moved(frame_of("TOOL-TRNS"), &["INS-IN"])) < 0.02);
    assert_eq!(bench.memory.emove.status.at.unwrap_or_default().location.as_str(), "TOOL-TRNS");
    assert_eq!(run(&mut bench, InsertTool), DONE, "it is in");
    assert!(bench.log().is_empty());
    assert_eq!(run(&mut bench, ReleaseTool), DONE);
    assert_eq!(
        bench.log(),
        ["RELEASE 400", "CAL-SENSOR", "GO-UNTIL REL-SLIDE REL-MY", "DELTA-MOVE REL-BACK"]
    );
    assert!(bench.off(&moved(frame_of("TOOL-TRNS"), &["INS-IN", "REL-SLIDE", "REL-BACK"])) < 0.02);
    assert!(!bench.memory.emove.status.held.is_held());
    assert_eq!(run(&mut bench, ReleaseTool), DONE, "it is left");
    assert!(bench.log().is_empty());
    assert_eq!(bench.run(MovToLoc, "", 0, "TOOL-SAFE", 0), DONE);
}

#[test]
fn a_tool_is_taken_out_of_the_drum() {
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
    assert_eq!(bench.memory.emove.status.held.object().unwrap_or_default().as_str(), "CUTTER");
    assert_eq!(run(&mut bench, AcquireTool), DONE, "it is held");
    assert!(bench.log().is_empty());
    assert_eq!(run(&mut bench, RemoveTool), DONE);
    assert_eq!(bench.log(), ["CAL-SENSOR", "GO-WHILE REM-OUT REM-FX"]);
    assert_eq!(run(&mut bench, RemoveTool), DONE, "it is out");
    assert!(bench.log().is_empty());
    assert_eq!(bench.run(MovToLoc, "", 0, "TOOL-SAFE", 0), DONE);
    assert!(bench.memory.emove.status.held.is_held());
}

#[test]
fn a_tool_in_the_drum_is_not_dragged_away() {
    let mut bench = inserted();
    assert_eq!(bench.run(MovToLoc, "", 0, "TOOL-SAFE", 0), error(Reason::NotPrepared));
    assert_eq!(run(&mut bench, ReleaseTool), DONE);
    let mut bench = inserted();
    assert_eq!(bench.run(Release, "CUTTER", 1, "", 3), DONE, "the fingers are open and around the tool");
    assert_eq!(run(&mut bench, AcquireTool), error(Reason::NotPrepared));
}

#[test]
fn tool_commands_begin_only_when_they_can() {
    let mut bench = Bench::ready("TOOL-SAFE", 3);
    assert_eq!(run(&mut bench, InsertTool), error(Reason::NothingHeld));
    assert_eq!(run(&mut bench, ReleaseTool), error(Reason::NotPrepared), "the robot is elsewhere");
    assert_eq!(run(&mut bench, RemoveTool), error(Reason::NothingHeld));
    let mut bench = loaded();
    assert_eq!(run(&mut bench, RemoveTool), error(Reason::NotPrepared), "the tool is not in the drum");
    assert_eq!(run(&mut bench, AcquireTool), error(Reason::NotPrepared), "it is held outside of the drum");
    let mut bench = Bench::ready("TOOL-SAFE", 3);
    bench.world.object = Some(248);
    assert_eq!(bench.run(EmoveVerb::GraspObj, "CUTTER", 1, "", 3), DONE);
    assert_eq!(bench.run(AcquireTool, "PIN", 1, "TOOL-TRNS", 3), error(Reason::AlreadyHolding));
    assert_eq!(bench.run(InsertTool, "PIN", 1, "TOOL-TRNS", 3), error(Reason::NothingHeld));
    // At the drum with closed fingers, or with a tool that is not in it, letting go may do anything.
    let mut bench = Bench::ready("TOOL-SAFE", 3);
    assert_eq!(run(&mut bench, ReleaseTool), error(Reason::NotPrepared));
    bench.hold("CUTTER", SIZE, 3);
    assert_eq!(run(&mut bench, ReleaseTool), error(Reason::NotPrepared));
    for verb in [InsertTool, ReleaseTool, AcquireTool, RemoveTool] {
        let mut bench = loaded();
        assert_eq!(bench.run(verb, "CUTTER", 1, "HOME", 3), error(Reason::NoRelativeMove), "{verb}");
        bench.world.frame = moved(frame_of("HOME"), &["300ty"]);
        bench.steps(3);
        assert_eq!(run(&mut bench, verb), error(Reason::UnknownStart), "{verb}");
    }
    let mut bench = loaded();
    bench.data.indexes.sensors = Index::default();
    assert_eq!(
        run(&mut bench, InsertTool),
        error(Reason::UnknownSensor),
        "a move that is to be guarded and is not"
    );
    let mut bench = empty();
    assert_eq!(bench.run(AcquireTool, "CUTTER", 9, "TOOL-TRNS", 3), error(Reason::UnknownGrip));
}

#[test]
fn a_force_that_must_not_come_stops_the_robot() {
    let detected = Mishap::Prim(PrimReport::DetectedErr, Reason::Detected);
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
fn a_contact_that_does_not_come_is_given_up() {
    let missed = Mishap::Prim(PrimReport::NotDetected, Reason::NotDetected);
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
fn a_tool_that_slips_is_noticed() {
    for (verb, before) in [(InsertTool, None), (RemoveTool, Some(()))] {
        let mut bench = if before.is_none() { loaded() } else { inserted() };
        bench.command(verb, "CUTTER", 1, "TOOL-TRNS", 3);
        bench.steps(4);
        bench.tool_grip.opening = 100;
        assert_eq!(bench.finish(), error(Reason::ObjectLost), "{verb}");
    }
    let mut bench = empty();
    assert_eq!(run(&mut bench, AcquireTool), error(Reason::GraspMissed), "there is no tool");
}

#[test]
fn a_failing_gripper_ends_the_command() {
    let mut bench = inserted();
    bench.spoil("RELEASE", Mishap::Jaws(JawsReport::Stuck));
    assert_eq!(run(&mut bench, ReleaseTool), error(Reason::JawsStuck));
    for word in ["POSE", "GRASP"] {
        let mut bench = empty();
        bench.spoil(word, Mishap::Jaws(JawsReport::Stuck));
        assert_eq!(run(&mut bench, AcquireTool), error(Reason::JawsStuck), "{word}");
    }
}

#[test]
fn a_failing_motion_ends_the_command() {
    let failed = Mishap::Prim(PrimReport::SensorError, Reason::SensorError);
    for (verb, words) in [
        (InsertTool, &["INS-NEAR", "CAL-SENSOR", "INS-IN"][..]),
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
