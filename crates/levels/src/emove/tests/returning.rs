//! A robot that the joystick box has moved off its place or its path (docs/design/recovery.md "Return").

use geometry::frame::{Frame, Vector, rotation_by};
use interfaces::{
    Reason,
    emove::EmoveVerb::{GraspObj, InsertTool, LocateObj, MovObjTo, MovToLoc, MovToObj, MovToVu, Release},
    track::Course,
};

use super::{
    bench::{Bench, DONE, EmoveLine, INTERRUPTIONS, error, frame_of, moved},
    drum::SIZE,
};
use crate::emove::tables::{
    Knowledge,
    resume::{EmoveOffset, EmoveStanding, Stance, stance},
    returning::{BroughtObject, EmoveOrigin, Lost, Near, Return, returning},
    track::{EmoveLine as Path, Mover, TrackChange, TrackStep, Tracking, track},
};

pub const SCENARIOS: &[fn()] = &[
    release_off_the_place_corrects_first,
    part_that_may_be_clamped_is_not_moved,
    grasp_and_picture_off_the_place_correct_first,
    motion_to_a_held_object_corrects_at_its_place_only,
];

const TO_HOME: EmoveLine = (MovToLoc, "", 0, "HOME", 0);
const TO_VISE: EmoveLine = (MovToLoc, "", 0, "VISE", 0);
const BLOCK_TO_VISE: EmoveLine = (MovObjTo, "BLOCK", 1, "VISE", 1);
const BLOCK_TO_BENCH: EmoveLine = (MovObjTo, "BLOCK", 1, "BENCH", 1);
const TO_BLOCK: EmoveLine = (MovToObj, "BLOCK", 1, "BENCH", 1);

/// The joystick box moves the robot during E-PAUSE, by at most 0.15 in per tick.
fn jog(bench: &mut Bench, by: [f64; 3]) {
    jog_and_turn(bench, by, [0.0; 3]);
}

fn jog_and_turn(bench: &mut Bench, by: [f64; 3], turn: [f64; 3]) {
    let (by, turn) = (Vector::from(by), Vector::from(turn));
    bench.stop();
    bench.world.joystick = true;
    bench.wait(3);
    let ticks = (by.norm() / 0.15).max(turn.norm() / 0.01).ceil().max(1.0);
    let mut done = 0.0;
    while done < ticks {
        done += 1.0;
        bench.world.frame.position += by / ticks;
        bench.world.frame = bench.world.frame.turned(&rotation_by(&(turn / ticks)));
        bench.step();
    }
    bench.wait(2);
    bench.world.joystick = false;
    bench.wait(6);
    bench.world.log.clear();
}

fn course(bench: &Bench) -> Course {
    bench.memory.emove.estimates.track.course
}

/// A robot that has brought a block to a place, and holds it.
fn brought(place: EmoveLine) -> Bench {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.perform(TO_BLOCK), DONE);
    bench.hold("BLOCK", 75, 1);
    assert_eq!(bench.perform(place), DONE);
    bench
}

#[test]
fn robot_near_its_place_returns_straight() {
    for (aside, motions) in [(0.01, &[][..]), (0.05, &["GOTO-PT"]), (0.3, &["GOTO-PT"]), (0.48, &["GOTO-PT"])]
    {
        let mut bench = Bench::ready("HOME", 1);
        jog(&mut bench, [0.0, 0.0, aside]);
        assert_eq!(bench.perform(TO_HOME), DONE);
        assert_eq!(bench.motions(), motions, "{aside} in");
        assert!(bench.off(&frame_of("HOME")) < 0.02, "{aside} in");
    }
    // A turned robot also returns.
    let mut bench = Bench::ready("HOME", 1);
    jog_and_turn(&mut bench, [0.0; 3], [0.0, 0.02, 0.0]);
    assert_eq!(bench.perform(TO_HOME), DONE);
    assert!(bench.off(&frame_of("HOME")) < 0.02);
}

#[test]
fn release_off_the_place_corrects_first() {
    let there = moved(frame_of("BENCH"), &["GRASP-MTB"]);
    let mut bench = brought(BLOCK_TO_BENCH);
    jog(&mut bench, [0.3, 0.0, 0.0]);
    assert_eq!(bench.perform((Release, "BLOCK", 1, "BENCH", 1)), DONE);
    let log = bench.log();
    let at = |word: &str| log.iter().position(|text| text.contains(word));
    assert_eq!(bench.motions(), ["GOTO-PT"]);
    assert!(at("GOTO-PT") < at("OPEN-GRIP") && at("OPEN-GRIP").is_some(), "{log:?}");
    assert!(bench.off(&there) < 0.01);
    assert_eq!(bench.memory.emove.status.placed.unwrap_or_default().site.location.as_str(), "BENCH");
}

#[test]
fn part_that_may_be_clamped_is_not_moved() {
    let release = (Release, "BLOCK", 1, "VISE", 1);
    // The vise has shifted the hand.
    let mut bench = brought(BLOCK_TO_VISE);
    bench.world.prim.sag = Vector::new(0.0, 0.06, 0.0);
    bench.wait(3);
    assert_eq!(bench.clone().perform(BLOCK_TO_VISE), DONE);
    assert_eq!(bench.perform(release), DONE);
    assert_eq!(bench.motions(), [""; 0]);
    // The joystick box has moved the hand.
    let mut bench = brought(BLOCK_TO_VISE);
    jog(&mut bench, [0.0, 0.3, 0.0]);
    for command in [release, BLOCK_TO_VISE, (GraspObj, "BLOCK", 1, "VISE", 1)] {
        let fork = &mut bench.clone();
        assert_eq!(fork.perform(command), error(Reason::OffPlace), "{}", command.0);
        assert_eq!(fork.motions(), [""; 0]);
    }
    // Empty fingers are free to move.
    let mut empty = brought(BLOCK_TO_VISE);
    assert_eq!(empty.perform(release), DONE);
    jog(&mut empty, [0.0, 0.3, 0.0]);
    assert_eq!(empty.perform((MovToObj, "BLOCK", 1, "VISE", 1)), DONE);
    assert!(empty.off(&moved(frame_of("VISE"), &["GRASP-MTB"])) < 0.02);
    // The part may be released after the robot has moved back.
    jog(&mut bench, [0.0, -0.3, 0.0]);
    assert_eq!(bench.perform(release), DONE);
    assert_eq!(bench.motions(), [""; 0]);
    // From farther away, only the joystick box can move the robot back.
    let mut bench = brought(BLOCK_TO_VISE);
    jog(&mut bench, [0.0, 0.0, 3.0]);
    assert_eq!(bench.perform(BLOCK_TO_VISE), error(Reason::UnknownStart));
    assert_eq!(bench.motions(), [""; 0]);
}

#[test]
fn grasp_and_picture_off_the_place_correct_first() {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.perform(TO_BLOCK), DONE);
    let mut lost = bench.clone();
    jog(&mut bench, [0.2, 0.0, 0.0]);
    bench.world.object = Some(75);
    assert_eq!(bench.perform((GraspObj, "BLOCK", 1, "BENCH", 1)), DONE);
    assert_eq!(bench.motions(), ["GOTO-PT"]);
    assert!(bench.off(&moved(frame_of("BENCH"), &["GRASP-MTB"])) < 0.01);
    // At an unknown place no grasp is possible.
    jog(&mut lost, [0.0, 0.0, 2.0]);
    assert_eq!(lost.perform((GraspObj, "BLOCK", 1, "BENCH", 1)), error(Reason::UnknownStart));
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.perform((MovToVu, "BLOCK", 1, "BENCH", 1)), DONE);
    jog(&mut bench, [0.2, 0.0, 0.0]);
    assert_eq!(bench.perform((LocateObj, "BLOCK", 1, "BENCH", 1)), DONE);
    assert_eq!(bench.motions().len(), 3, "back, over the part, and turned with it: {:?}", bench.world.log);
}

#[test]
fn jog_near_a_located_object_discards_its_picture() {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.perform((MovToVu, "BLOCK", 1, "BENCH", 1)), DONE);
    assert_eq!(bench.perform((LocateObj, "BLOCK", 1, "BENCH", 1)), DONE);
    let is_located = |bench: &Bench| bench.memory.emove.status.located.is_some();
    let mut far = bench.clone();
    jog(&mut far, [0.3, 0.0, 0.0]);
    assert!(is_located(&far), "the camera is {:.1} in from the object", far.off(&frame_of("BENCH")));
    assert_eq!(bench.perform(TO_BLOCK), DONE);
    assert!(is_located(&bench));
    jog(&mut bench, [0.3, 0.0, 0.0]);
    assert!(!is_located(&bench));
}

#[test]
fn motion_to_a_held_object_corrects_at_its_place_only() {
    let mut bench = brought(BLOCK_TO_BENCH);
    assert_eq!(bench.perform(TO_BLOCK), DONE);
    assert_eq!(bench.motions(), [""; 0]);
    assert_eq!(bench.clone().perform((MovToObj, "BLOCK", 1, "VISE", 1)), error(Reason::AlreadyHolding));
    jog(&mut bench, [0.2, 0.0, 0.0]);
    assert_eq!(bench.perform(TO_BLOCK), DONE);
    assert_eq!(bench.motions(), ["GOTO-PT"]);
    assert!(bench.memory.emove.status.held.is_held(), "the fingers stay closed");
}

#[test]
fn robot_moved_by_hand_retraces_its_path() {
    let mut bench = Bench::ready("HOME", 1);
    bench.world.prim.by_steps = true;
    let steps = [[3.0, 0.0, 0.0], [0.0, 0.0, 2.0], [0.0, -1.5, 0.0]];
    let mut corners = Vec::new();
    for by in steps {
        jog(&mut bench, by);
        corners.push(bench.world.frame);
        assert_eq!(course(&bench), Course::Tracked);
    }
    assert!(bench.memory.emove.status.at.is_none());
    let [first, second, ..] = corners[..] else { panic!() };
    let mut fork = bench.clone();
    let near = fork.pass(TO_HOME, [first, second]);
    assert!(near.iter().all(|inches| *inches < 0.15), "{near:?}");
    assert!(fork.off(&frame_of("HOME")) < 0.02);
    assert_eq!(fork.at(), "HOME");
    // For another goal the robot first returns to the place that it has left.
    let near = bench.pass(TO_VISE, [second, first, frame_of("HOME")]);
    assert!(near.iter().all(|inches| *inches < 0.15), "{near:?}");
}

#[test]
fn motion_back_by_hand_shortens_the_recorded_path() {
    let mut bench = Bench::ready("HOME", 1);
    bench.world.prim.by_steps = true;
    for by in [
        [4.0, 0.0, 0.0],
        [-2.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        [0.5, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
    ] {
        jog(&mut bench, by);
    }
    assert_eq!((course(&bench), bench.memory.emove.estimates.track.count), (Course::Tracked, 1));
    let far = moved(frame_of("HOME"), &[]);
    let far = Frame { position: far.position + Vector::new(4.0, 0.0, 0.0), ..far };
    let [near] = bench.pass(TO_HOME, [far]);
    assert!(near > 2.0, "{near}");
    // A robot moved back is at its place again.
    let mut bench = Bench::ready("HOME", 1);
    jog(&mut bench, [4.0, 0.0, 0.0]);
    jog(&mut bench, [-4.1, 0.0, 0.0]);
    assert_eq!(course(&bench), Course::Known);
    assert_eq!(bench.perform(TO_HOME), DONE);
    assert_eq!(bench.motions(), ["GOTO-PT"]);
}

#[test]
fn interrupted_return_resumes_from_every_tick() {
    let mut bench = Bench::ready("HOME", 1);
    bench.world.prim.by_steps = true;
    jog(&mut bench, [3.0, 0.0, 0.0]);
    jog(&mut bench, [0.0, 0.0, 2.0]);
    for interrupt in INTERRUPTIONS {
        for aside in [0.0, 1.0] {
            for mut fork in bench.during(TO_HOME) {
                interrupt(&mut fork);
                if aside > 0.0 {
                    jog(&mut fork, [0.0, aside, 0.0]);
                }
                assert_eq!(fork.perform(TO_HOME), DONE, "{aside} {:?}", course(&fork));
                assert!(fork.off(&frame_of("HOME")) < 0.02);
            }
        }
    }
}

#[test]
fn robot_moved_off_its_path_returns_to_it_and_continues() {
    let mut bench = Bench::ready("HOME", 0);
    bench.world.prim.by_steps = true;
    bench.send((MovToLoc, "", 0, "VISE", 0));
    bench.wait(30);
    bench.stop();
    let left = bench.world.frame;
    jog(&mut bench, [4.0, 0.0, 0.0]);
    jog(&mut bench, [0.0, 3.0, 0.0]);
    assert_eq!(course(&bench), Course::Tracked);
    for goal in [TO_VISE, TO_HOME] {
        let mut fork = bench.clone();
        let [near] = fork.pass(goal, [left]);
        assert!(near < 4.2, "{near}: within the corridor of the path");
        assert!(fork.off(&frame_of(goal.3)) < 0.02);
    }
}

#[test]
fn incomplete_record_allows_short_returns_only() {
    let miss = |bench: &mut Bench, by: [f64; 3]| {
        bench.stop();
        bench.world.joystick = true;
        bench.wait(3);
        bench.world.frame.position += Vector::from(by);
        bench.sleep(3);
        bench.wait(2);
        bench.world.joystick = false;
        bench.wait(6);
        bench.stop();
        bench.wait(100);
    };
    // The robot moves straight to a resting place nearby.
    for (by, end) in [(4.0, DONE), (11.0, DONE), (13.0, error(Reason::UnknownStart))] {
        let mut bench = Bench::ready("HOME", 1);
        miss(&mut bench, [by, 0.0, 0.0]);
        assert_eq!(course(&bench), Course::Broken);
        assert_eq!(bench.perform(TO_HOME), end, "{by}");
        assert_eq!(bench.motions().len(), usize::from(end == DONE), "{by}");
    }
    // The robot leaves a nest against its approach, and enters it again.
    let nest = moved(frame_of("BENCH"), &["GRASP-MTB"]);
    let outermost = moved(nest, &["A/D-5"]);
    let up = (outermost.position - nest.position).normalize();
    let aside = up.cross(&Vector::new(0.3, 0.5, 0.7)).normalize();
    for (by, end) in [
        (up * 2.0 + aside, DONE),
        (up * 4.0, DONE),
        (up * 2.0 + aside * 2.5, error(Reason::UnknownStart)),
        (up * 9.0, error(Reason::UnknownStart)),
    ] {
        let mut bench = Bench::ready("HOME", 1);
        assert_eq!(bench.perform(TO_BLOCK), DONE);
        bench.world.prim.by_steps = true;
        miss(&mut bench, by.into());
        if end == DONE {
            let start = bench.world.frame;
            let level = Frame { position: start.position + up * (5.0 - by.dot(&up)), ..start };
            let near = bench.pass(TO_BLOCK, [level, outermost]);
            assert!(near[0] < 0.05 && near[1] < 1.1, "{near:?}");
            assert!(bench.off(&nest) < 0.02);
        } else {
            assert_eq!(bench.perform(TO_BLOCK), end);
        }
    }
}

#[test]
fn sunken_arm_waits_for_the_joystick_box() {
    for led in [false, true] {
        let mut bench = Bench::ready("HOME", 1);
        bench.stop();
        bench.world.prim.restarts = true;
        bench.world.joystick = led;
        for _ in 0..20 {
            bench.world.frame.position.z -= 0.15;
            bench.step();
        }
        bench.world.prim.restarts = false;
        bench.world.joystick = false;
        bench.wait(10);
        assert_eq!(course(&bench), Course::Adrift);
        assert_eq!(bench.perform(TO_HOME), error(Reason::UnknownStart));
        // Moved near to a known place by the operator, the robot is found there.
        jog(&mut bench, [0.0, 0.0, 2.8]);
        bench.stop();
        assert_eq!(bench.perform(TO_HOME), DONE);
    }
}

#[test]
fn path_is_recorded_up_to_its_capacity() {
    let mut bench = Bench::ready("HOME", 1);
    bench.world.prim.by_steps = true;
    for _ in 0..10 {
        jog(&mut bench, [1.0, 0.0, 0.0]);
        jog(&mut bench, [0.0, 0.0, 1.0]);
    }
    assert_eq!(course(&bench), Course::Tracked);
    assert_eq!(bench.clone().perform(TO_HOME), DONE);
    for _ in 0..10 {
        jog(&mut bench, [1.0, 0.0, 0.0]);
        jog(&mut bench, [0.0, 0.0, 1.0]);
    }
    assert_eq!(course(&bench), Course::Broken);
    // A straight path has two ends, with a turn as well.
    let mut bench = Bench::ready("HOME", 1);
    jog(&mut bench, [20.0, 0.0, 0.0]);
    assert_eq!(bench.memory.emove.estimates.track.count, 1);
    jog_and_turn(&mut bench, [0.0; 3], [0.0, 0.3, 0.0]);
    assert_eq!(course(&bench), Course::Tracked);
    assert_eq!(bench.perform(TO_HOME), DONE);
}

#[test]
fn tool_moved_in_the_drum_is_inserted_again() {
    let mut bench = Bench::ready("TOOL-SAFE", 3);
    bench.hold("CUTTER", SIZE, 3);
    assert_eq!(bench.perform((InsertTool, "CUTTER", 1, "TOOL-TRNS", 3)), DONE);
    let inside = bench.world.frame;
    assert_eq!(bench.clone().perform((InsertTool, "CUTTER", 1, "TOOL-TRNS", 3)), DONE);
    jog(&mut bench, (inside.x() * -0.4).into());
    assert_eq!(bench.perform((InsertTool, "CUTTER", 1, "TOOL-TRNS", 3)), DONE);
    assert_eq!(bench.log(), ["GO-WHILE INS-IN INS-FX"]);
    assert!(bench.off(&inside) < 0.02);
}

#[test]
fn return_table_decides_by_record_and_surroundings() {
    for &resolvers in Knowledge::ALL {
        for &course in Course::ALL {
            for &origin in EmoveOrigin::ALL {
                for &freight in BroughtObject::ALL {
                    for &near in Near::ALL {
                        let lost = Lost { resolvers, course, origin, freight, near };
                        let safe = resolvers == Knowledge::Known
                            && course != Course::Adrift
                            && origin != EmoveOrigin::Drum
                            && freight == BroughtObject::Free;
                        let expected = match (safe, course, origin, near) {
                            (false, ..) => Return::Refuse,
                            (_, Course::Tracked, EmoveOrigin::Place | EmoveOrigin::Way, _) => Return::Retrace,
                            (.., Near::Resting) => Return::Straight,
                            (.., Near::Nest) => Return::Out,
                            (.., Near::Nothing) => Return::Refuse,
                        };
                        assert_eq!(returning((), &lost).action, expected, "{lost:?}");
                    }
                }
            }
        }
    }
    let stances = [Stance::Stay, Stance::Correct, Stance::RefuseOff, Stance::RefuseStart];
    for (&offset, expected) in EmoveOffset::ALL.iter().zip(stances) {
        assert_eq!(stance((), &EmoveStanding { offset }).action, expected, "{offset:?}");
    }
}

#[test]
fn track_table_decides_by_the_source_of_motion() {
    let known = Tracking {
        place: Knowledge::Unknown,
        course: Course::Known,
        mover: Mover::Box,
        line: Path::Sound,
        step: TrackStep::Near,
    };
    let tracked = Tracking { course: Course::Tracked, ..known };
    for (tracking, row, expected) in [
        (Tracking { place: Knowledge::Known, ..tracked }, 1, TrackChange::Note),
        (Tracking { course: Course::None, ..known }, 2, TrackChange::Keep),
        (Tracking { course: Course::Adrift, ..known }, 2, TrackChange::Keep),
        (Tracking { line: Path::Failed, ..known }, 3, TrackChange::Drift),
        (Tracking { line: Path::Failed, ..tracked }, 3, TrackChange::Drift),
        (Tracking { course: Course::Broken, ..known }, 4, TrackChange::Keep),
        (Tracking { mover: Mover::Hold, ..known }, 5, TrackChange::Drift),
        (known, 6, TrackChange::Begin),
        (Tracking { step: TrackStep::Far, ..known }, 7, TrackChange::Break),
        (Tracking { mover: Mover::Emove, step: TrackStep::Far, ..tracked }, 8, TrackChange::Keep),
        (tracked, 9, TrackChange::Add),
        (Tracking { step: TrackStep::Back, ..tracked }, 10, TrackChange::Shorten),
        (Tracking { mover: Mover::Hold, step: TrackStep::Far, ..tracked }, 11, TrackChange::Break),
    ] {
        let decision = track((), &tracking);
        assert_eq!((decision.row, decision.action), (row, expected), "{tracking:?}");
    }
}
