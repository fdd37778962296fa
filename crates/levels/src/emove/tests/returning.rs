//! A robot that the joystick box has moved off its place or its path (docs/design/recovery.md "Return").

use geometry::frame::{Frame, Vector, rotation_by};
use interfaces::{
    Reason, StatusReport,
    emove::EmoveVerb::{GraspObj, InsertTool, LocateObj, MovObjTo, MovToLoc, MovToObj, MovToVu, Release},
    track::Course,
};

use super::{
    bench::{Bench, DONE, error, frame_of, moved},
    drum::SIZE,
    recovery::{paused, send},
};
use crate::emove::{
    Emove,
    tables::{
        Knowledge,
        resume::{Offset, Stance, Standing, stance},
        returning::{Freight, Lost, Near, Origin, Return, returning},
        track::{Line, Mover, Record, Step, Tracking, track},
    },
};

pub const SCENARIOS: &[fn()] = &[
    a_robot_beside_its_place_goes_back_straight,
    a_release_beside_the_place_corrects_first,
    a_part_that_may_be_clamped_is_not_moved,
    a_grasp_and_a_picture_beside_the_place_correct_first,
    a_held_object_is_gone_to_only_where_it_is,
];

type Command<'a> = (interfaces::emove::EmoveVerb, &'a str, i32, &'a str, u8);

const TO_HOME: Command<'_> = (MovToLoc, "", 0, "HOME", 0);
const TO_VISE: Command<'_> = (MovToLoc, "", 0, "VISE", 0);
const BLOCK_TO_VISE: Command<'_> = (MovObjTo, "BLOCK", 1, "VISE", 1);
const BLOCK_TO_BENCH: Command<'_> = (MovObjTo, "BLOCK", 1, "BENCH", 1);
const TO_BLOCK: Command<'_> = (MovToObj, "BLOCK", 1, "BENCH", 1);

/// The joystick box moves the robot while E-PAUSE stands, 0.15 in in a tick at most.
fn jog(bench: &mut Bench, by: [f64; 3]) {
    jog_and_turn(bench, by, [0.0; 3]);
}

fn jog_and_turn(bench: &mut Bench, by: [f64; 3], turn: [f64; 3]) {
    let (by, turn) = (Vector::from(by), Vector::from(turn));
    paused(bench);
    bench.world.joystick = true;
    bench.steps(3);
    let ticks = (by.norm() / 0.15).max(turn.norm() / 0.01).ceil().max(1.0);
    let mut done = 0.0;
    while done < ticks {
        done += 1.0;
        bench.world.frame.position += by / ticks;
        bench.world.frame = bench.world.frame.turned(&rotation_by(&(turn / ticks)));
        bench.steps(1);
    }
    bench.steps(2);
    bench.world.joystick = false;
    bench.steps(6);
    bench.world.log.clear();
}

/// How near the robot comes to each of some frames while it executes a command, in.
fn passed<const N: usize>(bench: &mut Bench, goal: Command<'_>, frames: [Frame; N]) -> [f64; N] {
    let mut nearest = [f64::INFINITY; N];
    bench.world.log.clear();
    bench.command(goal.0, goal.1, goal.2, goal.3, goal.4);
    for _ in 0..1000 {
        bench.step();
        for (nearest, frame) in nearest.iter_mut().zip(&frames) {
            *nearest = nearest.min(bench.world.frame.distance(frame).inches);
        }
        let status = bench.memory.emove.status;
        if status.echo == bench.memory.subtask.emove.number && status.report != StatusReport::Executing {
            assert_eq!((status.report, status.reason), DONE, "{:?}", bench.world.log);
            return nearest;
        }
    }
    panic!("never over: {:?}", bench.world.log);
}

fn course(bench: &Bench) -> Course {
    bench.memory.emove.beliefs.track.course
}

/// A robot with a block in its fingers, which it has brought to a place.
fn brought(place: Command<'_>) -> Bench {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(send(&mut bench, TO_BLOCK), DONE);
    bench.hold("BLOCK", 75, 1);
    assert_eq!(send(&mut bench, place), DONE);
    bench
}

#[test]
fn a_robot_beside_its_place_goes_back_straight() {
    for (aside, motions) in [(0.01, &[][..]), (0.05, &["GOTO-PT"]), (0.3, &["GOTO-PT"]), (0.48, &["GOTO-PT"])]
    {
        let mut bench = Bench::ready("HOME", 1);
        jog(&mut bench, [0.0, 0.0, aside]);
        assert_eq!(send(&mut bench, TO_HOME), DONE);
        assert_eq!(bench.motions(), motions, "{aside} in");
        assert!(bench.off(&frame_of("HOME")) < 0.02, "{aside} in");
    }
    // So does one that is turned.
    let mut bench = Bench::ready("HOME", 1);
    jog_and_turn(&mut bench, [0.0; 3], [0.0, 0.02, 0.0]);
    assert_eq!(send(&mut bench, TO_HOME), DONE);
    assert!(bench.off(&frame_of("HOME")) < 0.02);
}

#[test]
fn a_release_beside_the_place_corrects_first() {
    let there = moved(frame_of("BENCH"), &["GRASP-MTB"]);
    let mut bench = brought(BLOCK_TO_BENCH);
    jog(&mut bench, [0.3, 0.0, 0.0]);
    assert_eq!(send(&mut bench, (Release, "BLOCK", 1, "BENCH", 1)), DONE);
    let log = bench.log();
    let at = |word: &str| log.iter().position(|text| text.contains(word));
    assert_eq!(bench.motions(), ["GOTO-PT"]);
    assert!(at("GOTO-PT") < at("OPEN-GRIP") && at("OPEN-GRIP").is_some(), "{log:?}");
    assert!(bench.off(&there) < 0.01);
    assert_eq!(bench.memory.emove.status.placed.unwrap_or_default().site.location.as_str(), "BENCH");
}

#[test]
fn a_part_that_may_be_clamped_is_not_moved() {
    let release = (Release, "BLOCK", 1, "VISE", 1);
    // The vise has shifted the hand.
    let mut bench = brought(BLOCK_TO_VISE);
    bench.prim.sag = Vector::new(0.0, 0.06, 0.0);
    bench.steps(3);
    assert_eq!(send(&mut bench.clone(), BLOCK_TO_VISE), DONE);
    assert_eq!(send(&mut bench, release), DONE);
    assert_eq!(bench.motions(), [""; 0]);
    // The joystick box has moved it.
    let mut bench = brought(BLOCK_TO_VISE);
    jog(&mut bench, [0.0, 0.3, 0.0]);
    for command in [release, BLOCK_TO_VISE, (GraspObj, "BLOCK", 1, "VISE", 1)] {
        let fork = &mut bench.clone();
        assert_eq!(send(fork, command), error(Reason::OffPlace), "{}", command.0);
        assert_eq!(fork.motions(), [""; 0]);
    }
    // Empty fingers are free to move.
    let mut empty = brought(BLOCK_TO_VISE);
    assert_eq!(send(&mut empty, release), DONE);
    jog(&mut empty, [0.0, 0.3, 0.0]);
    assert_eq!(send(&mut empty, (MovToObj, "BLOCK", 1, "VISE", 1)), DONE);
    assert!(empty.off(&moved(frame_of("VISE"), &["GRASP-MTB"])) < 0.02);
    // Moved back, the part may be let go.
    jog(&mut bench, [0.0, -0.3, 0.0]);
    assert_eq!(send(&mut bench, release), DONE);
    assert_eq!(bench.motions(), [""; 0]);
    // From farther away only the joystick box leads back.
    let mut bench = brought(BLOCK_TO_VISE);
    jog(&mut bench, [0.0, 0.0, 3.0]);
    assert_eq!(send(&mut bench, BLOCK_TO_VISE), error(Reason::UnknownStart));
    assert_eq!(bench.motions(), [""; 0]);
}

#[test]
fn a_grasp_and_a_picture_beside_the_place_correct_first() {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(send(&mut bench, TO_BLOCK), DONE);
    let mut lost = bench.clone();
    jog(&mut bench, [0.2, 0.0, 0.0]);
    bench.world.object = Some(75);
    assert_eq!(send(&mut bench, (GraspObj, "BLOCK", 1, "BENCH", 1)), DONE);
    assert_eq!(bench.motions(), ["GOTO-PT"]);
    assert!(bench.off(&moved(frame_of("BENCH"), &["GRASP-MTB"])) < 0.01);
    // Where the robot is lost there is nothing to close on.
    jog(&mut lost, [0.0, 0.0, 2.0]);
    assert_eq!(send(&mut lost, (GraspObj, "BLOCK", 1, "BENCH", 1)), error(Reason::UnknownStart));
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(send(&mut bench, (MovToVu, "BLOCK", 1, "BENCH", 1)), DONE);
    jog(&mut bench, [0.2, 0.0, 0.0]);
    assert_eq!(send(&mut bench, (LocateObj, "BLOCK", 1, "BENCH", 1)), DONE);
    assert_eq!(bench.motions().len(), 3, "back, over the part, and turned with it: {:?}", bench.world.log);
}

#[test]
fn a_jog_near_a_located_object_discards_its_picture() {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(send(&mut bench, (MovToVu, "BLOCK", 1, "BENCH", 1)), DONE);
    assert_eq!(send(&mut bench, (LocateObj, "BLOCK", 1, "BENCH", 1)), DONE);
    let is_located = |bench: &Bench| bench.memory.emove.status.located.is_some();
    let mut far = bench.clone();
    jog(&mut far, [0.3, 0.0, 0.0]);
    assert!(is_located(&far), "the camera is {:.1} in from the object", far.off(&frame_of("BENCH")));
    assert_eq!(send(&mut bench, TO_BLOCK), DONE);
    assert!(is_located(&bench));
    jog(&mut bench, [0.3, 0.0, 0.0]);
    assert!(!is_located(&bench));
}

#[test]
fn a_held_object_is_gone_to_only_where_it_is() {
    let mut bench = brought(BLOCK_TO_BENCH);
    assert_eq!(send(&mut bench, TO_BLOCK), DONE);
    assert_eq!(bench.motions(), [""; 0]);
    assert_eq!(send(&mut bench.clone(), (MovToObj, "BLOCK", 1, "VISE", 1)), error(Reason::AlreadyHolding));
    jog(&mut bench, [0.2, 0.0, 0.0]);
    assert_eq!(send(&mut bench, TO_BLOCK), DONE);
    assert_eq!(bench.motions(), ["GOTO-PT"]);
    assert!(bench.memory.emove.status.held.is_held(), "the fingers stay closed");
}

#[test]
fn a_robot_that_was_moved_away_goes_back_as_it_came() {
    let mut bench = Bench::ready("HOME", 1);
    bench.prim.by_steps = true;
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
    let near = passed(&mut fork, TO_HOME, [first, second]);
    assert!(near.iter().all(|inches| *inches < 0.15), "{near:?}");
    assert!(fork.off(&frame_of("HOME")) < 0.02);
    assert_eq!(fork.memory.emove.status.at.unwrap_or_default().site.location.as_str(), "HOME");
    // To another place it goes by way of the place that it has left.
    let near = passed(&mut bench, TO_VISE, [second, first, frame_of("HOME")]);
    assert!(near.iter().all(|inches| *inches < 0.15), "{near:?}");
}

#[test]
fn moving_back_by_hand_shortens_the_way_back() {
    let mut bench = Bench::ready("HOME", 1);
    bench.prim.by_steps = true;
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
    assert_eq!((course(&bench), bench.memory.emove.beliefs.track.count), (Course::Tracked, 1));
    let far = moved(frame_of("HOME"), &[]);
    let far = Frame { position: far.position + Vector::new(4.0, 0.0, 0.0), ..far };
    let [near] = passed(&mut bench, TO_HOME, [far]);
    assert!(near > 2.0, "{near}");
    // Back at its place it is at a place.
    let mut bench = Bench::ready("HOME", 1);
    jog(&mut bench, [4.0, 0.0, 0.0]);
    jog(&mut bench, [-4.1, 0.0, 0.0]);
    assert_eq!(course(&bench), Course::Known);
    assert_eq!(send(&mut bench, TO_HOME), DONE);
    assert_eq!(bench.motions(), ["GOTO-PT"]);
}

#[test]
fn a_return_that_is_interrupted_goes_on_from_every_tick() {
    let mut bench = Bench::ready("HOME", 1);
    bench.prim.by_steps = true;
    jog(&mut bench, [3.0, 0.0, 0.0]);
    jog(&mut bench, [0.0, 0.0, 2.0]);
    for restarts in [false, true] {
        for aside in [0.0, 1.0] {
            bench.clone().at_every_tick(TO_HOME, |fork| {
                if restarts {
                    fork.process = Emove::default();
                    assert_eq!(fork.finish(), error(Reason::Restarted));
                }
                paused(fork);
                if aside > 0.0 {
                    jog(fork, [0.0, aside, 0.0]);
                }
                assert_eq!(send(fork, TO_HOME), DONE, "{restarts} {aside} {:?}", course(fork));
                assert!(fork.off(&frame_of("HOME")) < 0.02);
            });
        }
    }
}

#[test]
fn a_robot_that_was_moved_off_its_path_goes_back_to_it_and_on() {
    let mut bench = Bench::ready("HOME", 0);
    bench.prim.by_steps = true;
    bench.write(MovToLoc, "", 0, "VISE", 0);
    bench.steps(30);
    paused(&mut bench);
    let left = bench.world.frame;
    jog(&mut bench, [4.0, 0.0, 0.0]);
    jog(&mut bench, [0.0, 3.0, 0.0]);
    assert_eq!(course(&bench), Course::Tracked);
    for goal in [TO_VISE, TO_HOME] {
        let mut fork = bench.clone();
        let [near] = passed(&mut fork, goal, [left]);
        assert!(near < 4.2, "{near}: within the corridor of the path");
        assert!(fork.off(&frame_of(goal.3)) < 0.02);
    }
}

#[test]
fn a_broken_record_leaves_the_short_ways() {
    let miss = |bench: &mut Bench, by: [f64; 3]| {
        paused(bench);
        bench.world.joystick = true;
        bench.steps(3);
        bench.dead.push("E-move");
        bench.world.frame.position += Vector::from(by);
        bench.steps(3);
        bench.dead.clear();
        bench.steps(2);
        bench.world.joystick = false;
        bench.steps(6);
        paused(bench);
        bench.steps(100);
    };
    // Straight to a resting place that is near.
    for (by, end) in [(4.0, DONE), (11.0, DONE), (13.0, error(Reason::UnknownStart))] {
        let mut bench = Bench::ready("HOME", 1);
        miss(&mut bench, [by, 0.0, 0.0]);
        assert_eq!(course(&bench), Course::Broken);
        assert_eq!(send(&mut bench, TO_HOME), end, "{by}");
        assert_eq!(bench.motions().len(), usize::from(end == DONE), "{by}");
    }
    // Out of a nest against its approach, and in again.
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
        assert_eq!(send(&mut bench, TO_BLOCK), DONE);
        bench.prim.by_steps = true;
        miss(&mut bench, by.into());
        if end == DONE {
            let start = bench.world.frame;
            let level = Frame { position: start.position + up * (5.0 - by.dot(&up)), ..start };
            let near = passed(&mut bench, TO_BLOCK, [level, outermost]);
            assert!(near[0] < 0.05 && near[1] < 1.1, "{near:?}");
            assert!(bench.off(&nest) < 0.02);
        } else {
            assert_eq!(send(&mut bench, TO_BLOCK), end);
        }
    }
}

#[test]
fn an_arm_that_has_sunk_waits_for_the_joystick_box() {
    for led in [false, true] {
        let mut bench = Bench::ready("HOME", 1);
        paused(&mut bench);
        bench.prim.restarts = true;
        bench.world.joystick = led;
        for _ in 0..20 {
            bench.world.frame.position.z -= 0.15;
            bench.steps(1);
        }
        bench.prim.restarts = false;
        bench.world.joystick = false;
        bench.steps(10);
        assert_eq!(course(&bench), Course::Adrift);
        assert_eq!(send(&mut bench, TO_HOME), error(Reason::UnknownStart));
        // Moved near to a known place by a person it is found there.
        jog(&mut bench, [0.0, 0.0, 2.8]);
        paused(&mut bench);
        assert_eq!(send(&mut bench, TO_HOME), DONE);
    }
}

#[test]
fn a_long_or_winding_path_is_recorded_as_far_as_there_is_room() {
    let mut bench = Bench::ready("HOME", 1);
    bench.prim.by_steps = true;
    for _ in 0..10 {
        jog(&mut bench, [1.0, 0.0, 0.0]);
        jog(&mut bench, [0.0, 0.0, 1.0]);
    }
    assert_eq!(course(&bench), Course::Tracked);
    assert_eq!(send(&mut bench.clone(), TO_HOME), DONE);
    for _ in 0..10 {
        jog(&mut bench, [1.0, 0.0, 0.0]);
        jog(&mut bench, [0.0, 0.0, 1.0]);
    }
    assert_eq!(course(&bench), Course::Broken);
    // A straight one has two ends, also a turn.
    let mut bench = Bench::ready("HOME", 1);
    jog(&mut bench, [20.0, 0.0, 0.0]);
    assert_eq!(bench.memory.emove.beliefs.track.count, 1);
    jog_and_turn(&mut bench, [0.0; 3], [0.0, 0.3, 0.0]);
    assert_eq!(course(&bench), Course::Tracked);
    assert_eq!(send(&mut bench, TO_HOME), DONE);
}

#[test]
fn a_tool_that_was_moved_in_the_drum_is_inserted_again() {
    let mut bench = Bench::ready("TOOL-SAFE", 3);
    bench.hold("CUTTER", SIZE, 3);
    assert_eq!(send(&mut bench, (InsertTool, "CUTTER", 1, "TOOL-TRNS", 3)), DONE);
    let inside = bench.world.frame;
    assert_eq!(send(&mut bench.clone(), (InsertTool, "CUTTER", 1, "TOOL-TRNS", 3)), DONE);
    jog(&mut bench, (inside.x() * -0.4).into());
    assert_eq!(send(&mut bench, (InsertTool, "CUTTER", 1, "TOOL-TRNS", 3)), DONE);
    assert_eq!(bench.log(), ["GO-WHILE INS-IN INS-FX"]);
    assert!(bench.off(&inside) < 0.02);
}

#[test]
fn the_way_back_follows_from_the_record_and_the_surroundings() {
    for &resolvers in Knowledge::ALL {
        for &course in Course::ALL {
            for &origin in Origin::ALL {
                for &freight in Freight::ALL {
                    for &near in Near::ALL {
                        let lost = Lost { resolvers, course, origin, freight, near };
                        let safe = resolvers == Knowledge::Known
                            && course != Course::Adrift
                            && origin != Origin::Drum
                            && freight == Freight::Free;
                        let expected = match (safe, course, origin, near) {
                            (false, ..) => Return::Refuse,
                            (_, Course::Tracked, Origin::Place | Origin::Way, _) => Return::Retrace,
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
    for (&offset, expected) in Offset::ALL.iter().zip(stances) {
        assert_eq!(stance((), &Standing { offset }).action, expected, "{offset:?}");
    }
}

#[test]
fn the_record_follows_what_moves_the_robot() {
    let known = Tracking {
        place: Knowledge::Unknown,
        course: Course::Known,
        mover: Mover::Box,
        line: Line::Sound,
        step: Step::Near,
    };
    let tracked = Tracking { course: Course::Tracked, ..known };
    for (tracking, row, expected) in [
        (Tracking { place: Knowledge::Known, ..tracked }, 1, Record::Note),
        (Tracking { course: Course::None, ..known }, 2, Record::Keep),
        (Tracking { course: Course::Adrift, ..known }, 2, Record::Keep),
        (Tracking { line: Line::Failed, ..known }, 3, Record::Drift),
        (Tracking { line: Line::Failed, ..tracked }, 3, Record::Drift),
        (Tracking { course: Course::Broken, ..known }, 4, Record::Keep),
        (Tracking { mover: Mover::Hold, ..known }, 5, Record::Drift),
        (known, 6, Record::Begin),
        (Tracking { step: Step::Far, ..known }, 7, Record::Break),
        (Tracking { mover: Mover::Emove, step: Step::Far, ..tracked }, 8, Record::Keep),
        (tracked, 9, Record::Add),
        (Tracking { step: Step::Back, ..tracked }, 10, Record::Shorten),
        (Tracking { mover: Mover::Hold, step: Step::Far, ..tracked }, 11, Record::Break),
    ] {
        let decision = track((), &tracking);
        assert_eq!((decision.row, decision.action), (row, expected), "{tracking:?}");
    }
}
