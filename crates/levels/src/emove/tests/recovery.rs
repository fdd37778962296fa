//! Motions that are interrupted and sent again, or followed by another command (docs/design/recovery.md "On the way",
//! "Replaced", "Estimates").

use geometry::frame::{Frame, Vector};
use interfaces::{
    Reason, StatusReport,
    emove::{
        EmoveVerb::{self, LocateObj, MovObjTo, MovToLoc, MovToObj, MovToVu, QcAttach, Release},
        Estimates,
    },
    prim::{PrimReport, PrimVerb},
};

use super::{
    bench::{Bench, DONE, EmoveLine, INTERRUPTIONS, ORDINARY, error, frame_of, moved},
    doubles::DeliveryFault,
};
use crate::emove::tables::resume::{
    CurrentLeg, EmoveRobot, GoalOf, MotionBeginning, MotionStart, ReturnPath, resume,
};

pub const SCENARIOS: &[fn()] = &[
    motion_at_an_object_resumes_forward_only,
    unlocked_ring_refuses_every_motion,
    loss_of_subtask_stops_everything,
];

const TO_VISE: EmoveLine = (MovObjTo, "BLOCK", 1, "VISE", 1);
const TO_HOME: EmoveLine = (MovToLoc, "", 0, "HOME", 0);

/// A robot at the bench with a block in its fingers.
fn loaded() -> Bench {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.run(MovToObj, "BLOCK", 1, "BENCH", 1), DONE);
    bench.hold("BLOCK", 75, 1);
    bench.world.prim.by_steps = true;
    bench
}

/// The end of the depart leg of a robot at the bench with a block.
fn departed() -> Frame {
    moved(frame_of("BENCH"), &["GRASP-MTB", "A/D-5"])
}

#[test]
fn interrupted_motion_resumes_to_its_goal_from_every_tick() {
    for interrupt in INTERRUPTIONS {
        let bench = loaded();
        let full = ["GO-THRU A/D-5", "GO-THRU", "GO-THRU A/D-5", "GOTO-PT"];
        let mut seen = [0; 5];
        for mut fork in bench.during(TO_VISE) {
            interrupt(&mut fork);
            let told = fork.motions().len();
            assert_eq!(fork.perform(TO_VISE), DONE, "{told}");
            let again = fork.motions();
            let rest = if again.is_empty() { &[] } else { &full[told.saturating_sub(1)..] };
            assert_eq!(again, rest, "no point is repeated, {told} points were sent");
            assert!(fork.off(&moved(frame_of("VISE"), &["GRASP-MTB"])) < 0.02);
            assert_eq!((fork.at(), fork.held()), ("VISE".to_owned(), "BLOCK".to_owned()));
            seen[told] += 1;
        }
        let mut bench = bench;
        assert_eq!(bench.perform(TO_VISE), DONE);
        assert_eq!(bench.motions(), full);
        assert!(seen[1..].iter().all(|ticks| *ticks > 0), "in every leg: {seen:?}");
    }
}

#[test]
fn motion_to_another_goal_passes_the_end_of_the_depart_leg() {
    let bench = loaded();
    let taken = moved(frame_of("BENCH"), &["GRASP-MTB"]);
    let mut seen = [0; 5];
    for mut fork in bench.during(TO_VISE) {
        let told = fork.stop();
        if fork.memory.emove.status.at.is_some() {
            continue;
        }
        let from = fork.world.frame.distance(&taken).inches;
        let [near] = fork.pass(TO_HOME, [taken]);
        let back = vec!["GO-THRU"; told.saturating_sub(1)];
        let then = if told == 1 { vec!["GO-THRU A/D-5"] } else { back };
        let then = then.into_iter().chain(["GO-THRU", "GOTO-PT"]).collect::<Vec<_>>();
        assert_eq!(fork.motions(), then, "{told} points were sent");
        assert!(fork.off(&frame_of("HOME")) < 0.02);
        // Points are passed within an inch.
        assert!(near > from.min(5.0) - 1.1, "{near} in: no return into the depart leg");
        seen[told] += 1;
    }
    assert!(seen[1..].iter().all(|ticks| *ticks > 0), "in every leg: {seen:?}");
    // A second interruption, on the way back, keeps the way.
    for ticks in (10..300).step_by(29) {
        for later in (5..120).step_by(17) {
            let mut bench = loaded();
            bench.send(TO_VISE);
            bench.wait(ticks);
            bench.stop();
            bench.send(TO_HOME);
            bench.wait(later);
            bench.stop();
            let [near] = bench.pass(TO_VISE, [departed()]);
            assert!(bench.off(&moved(frame_of("VISE"), &["GRASP-MTB"])) < 0.02, "{ticks} {later} {near}");
        }
    }
}

#[test]
fn motion_back_uses_the_approach_of_the_place() {
    let bench = loaded();
    for mut fork in bench.during(TO_VISE) {
        let told = fork.stop();
        let left = fork.memory.emove.status.at.is_none();
        assert_eq!(fork.perform((MovObjTo, "BLOCK", 1, "BENCH", 1)), DONE);
        assert!(fork.off(&moved(frame_of("BENCH"), &["GRASP-MTB"])) < 0.02);
        if left && told > 1 {
            let back = vec!["GO-THRU"; told - 1];
            let then = back.into_iter().chain(["GO-THRU A/D-5", "GOTO-PT"]).collect::<Vec<_>>();
            assert_eq!(fork.motions(), then);
        }
    }
    // An interrupted opening for the goal is ordered again when it is due.
    let mut bench = Bench::ready("HOME", 1);
    bench.world.prim.by_steps = true;
    for mut fork in bench.during((MovToObj, "BLOCK", 1, "BENCH", 1)) {
        fork.stop();
        assert_eq!(fork.perform((MovToObj, "BLOCK", 1, "BENCH", 1)), DONE);
        assert_eq!(fork.world.grip.opening, 300, "{:?}", fork.world.log);
    }
    // The camera over a part continues, or returns to the view.
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.run(MovToVu, "BLOCK", 1, "BENCH", 1), DONE);
    bench.world.prim.by_steps = true;
    for mut fork in bench.during((LocateObj, "BLOCK", 1, "BENCH", 1)) {
        fork.stop();
        for verb in [MovToVu, LocateObj, MovToObj] {
            assert_eq!(fork.perform((verb, "BLOCK", 1, "BENCH", 1)), DONE, "{verb} {:?}", fork.world.log);
        }
        assert_eq!(fork.perform(TO_HOME), DONE);
    }
}

#[test]
fn motion_at_an_object_resumes_forward_only() {
    let to_block = (MovToObj, "BLOCK", 1, "BENCH", 1);
    let to_pin = (MovToObj, "PIN", 1, "BENCH", 1);
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.perform(to_pin), DONE);
    // A pin two inches farther is still at the same place; it has no depart points.
    bench.world.prim.by_steps = true;
    let further = |bench: &mut Bench| {
        bench.send(to_pin);
        let record = &mut bench.memory.subtask.poses[0];
        record.pose = geometry::pose::Pose::from_frame(&moved(frame_of("BENCH"), &["300ty"]));
    };
    further(&mut bench);
    bench.wait(8);
    bench.stop();
    for other in [TO_HOME, to_block, to_pin] {
        assert_eq!(bench.perform(other), error(Reason::ForwardOnly));
        assert_eq!(bench.motions(), [""; 0], "no motion is ordered");
    }
    further(&mut bench);
    assert_eq!(bench.finish(), DONE);
    assert!(bench.off(&moved(frame_of("BENCH"), &["300ty", "GRASP-MTB"])) < 0.02);
    // From a plain location, or from a view, the robot can go back.
    for (verb, gripper) in [(MovToLoc, 1), (MovToVu, 1)] {
        let mut bench = Bench::ready("HOME", gripper);
        assert_eq!(bench.run(verb, "BLOCK", 1, "BENCH", 1), DONE);
        bench.world.prim.by_steps = true;
        bench.send(to_pin);
        bench.wait(6);
        bench.stop();
        assert_eq!(bench.perform(TO_HOME), DONE, "{verb}");
    }
}

/// E-PAUSE stops all processes itself. Every other command waits until they are at rest, whether it is accepted or
/// refused.
#[test]
fn new_command_stops_the_running_one_before_it_is_answered() {
    for (next, end) in [
        (TO_HOME, DONE),
        ((MovToLoc, "", 0, "", 0), error(Reason::NoDestination)),
        ((MovToObj, "BLOCK", 7, "BENCH", 1), error(Reason::UnknownGrip)),
        ((Release, "BLOCK", 1, "VISE", 1), DONE),
    ] {
        let bench = loaded();
        for mut fork in bench.during(TO_VISE) {
            let prim = &fork.memory.prim.status;
            let moving = prim.echo != fork.memory.emove.prim.number || prim.report == PrimReport::Executing;
            let before = fork.world.log.len();
            assert_eq!(fork.execute(next), end, "{:?}", fork.world.log);
            // The order of the tick before is on its way to Prim.
            let at = fork.log()[before..].iter().position(|text| *text == "PAUSE");
            assert!(!moving || at.is_some_and(|at| at <= 1), "{:?}", fork.world.log);
            fork.assert_stands();
        }
    }
}

/// A command found after a restart is not executed, and its orders are stopped.
#[test]
fn restarted_emove_stops_its_orders() {
    let bench = loaded();
    for mut fork in bench.during(TO_VISE) {
        let (prim, sent) = (fork.memory.prim.status, fork.memory.emove.prim);
        let arrived =
            prim.echo == sent.number && prim.report == PrimReport::Done && sent.command == PrimVerb::GotoPt;
        fork.restart_and_finish();
        fork.wait(2);
        assert!(arrived || fork.memory.emove.prim.command == PrimVerb::Pause);
        fork.assert_stands();
    }
    // The operator keeps the robot.
    let mut bench = Bench::ready("HOME", 1);
    bench.spoil("GO-THRU", DeliveryFault::Joystick);
    assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), (StatusReport::JoystickOn, Reason::JoystickOn));
    let sent = bench.memory.emove.prim.number;
    bench.restart();
    bench.wait(5);
    assert_eq!(bench.memory.emove.prim.number, sent, "no order is sent");
}

#[test]
fn loss_of_subtask_stops_everything() {
    let bench = loaded();
    for mut fork in bench.during(TO_VISE) {
        let was_executing = fork.memory.emove.status.report == StatusReport::Executing;
        fork.world.dead.push("Subtask");
        fork.wait(60);
        fork.assert_stands();
        let status = fork.memory.emove.status;
        if was_executing {
            let ended = (status.report, status.reason);
            assert!([error(Reason::NeighbourLost), (StatusReport::Done, Reason::None)].contains(&ended));
        }
    }
}

#[test]
fn restarted_emove_keeps_its_estimates() {
    let estimates = |bench: &Bench| {
        let Estimates { place, held, placed, located, exchange, .. } = bench.memory.emove.estimates;
        (place, held, placed, located, exchange)
    };
    // The estimates are the located object before the grasp, then the held one, then the released one.
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.run(MovToVu, "BLOCK", 1, "BENCH", 1), DONE);
    for (verb, location) in [
        (LocateObj, "BENCH"),
        (MovToObj, "BENCH"),
        (EmoveVerb::GraspObj, "BENCH"),
        (MovObjTo, "VISE"),
        (Release, "VISE"),
    ] {
        if verb == EmoveVerb::GraspObj {
            bench.world.object = Some(75);
        }
        assert_eq!(bench.run(verb, "BLOCK", 1, location, 1), DONE, "{verb}");
        let before = estimates(&bench);
        bench.restart_and_finish();
        assert_eq!(estimates(&bench), before, "after {verb}");
        bench.stop();
        assert_eq!(estimates(&bench), before, "after {verb}");
    }
    assert!(bench.memory.emove.status.placed.is_some());
    // Estimates that the sensors contradict are discarded.
    let mut bench = loaded();
    bench.held = true;
    bench.world.frame = frame_of("HOME");
    bench.world.grip.opening = 200;
    bench.world.object = None;
    bench.wait(3);
    bench.held = false;
    bench.restart_and_finish();
    let status = bench.memory.emove.status;
    assert_eq!((status.at.is_some(), status.held.is_held()), (false, false));
    // A gripper exchange is one of the estimates.
    let mut bench = Bench::ready("HOLSTER-R", 1);
    bench.world.frame = moved(frame_of("HOLSTER-R"), &["QCA-LIFT"]);
    bench.world.prim.by_steps = true;
    bench.command(QcAttach, "GRIPPER-1", 2, "HOLSTER-R", 1);
    bench.wait(8);
    bench.restart_and_finish();
    assert_eq!(bench.memory.emove.status.exchange, Some(1));
}

fn nudge(bench: &mut Bench, by_hand: bool, does: impl FnOnce(&mut Frame)) {
    if by_hand {
        bench.lead(|bench| does(&mut bench.world.frame));
    } else {
        bench.wait(5);
        does(&mut bench.world.frame);
        bench.wait(13);
    }
}

/// A bare robot on its way from HOME to the vise for a number of ticks.
fn under_way(ticks: u32) -> Bench {
    let mut bench = Bench::ready("HOME", 0);
    bench.world.prim.by_steps = true;
    bench.send((MovToLoc, "", 0, "VISE", 0));
    bench.wait(ticks);
    bench
}

#[test]
fn nudge_inside_the_corridor_keeps_the_path() {
    for (aside, by_hand, end) in [
        (0.4, false, DONE),
        (0.6, false, error(Reason::UnknownStart)),
        (2.5, true, DONE),
        (-2.5, true, DONE),
        (4.5, true, error(Reason::UnknownStart)),
    ] {
        // The robot moves to the second point of the way from HOME, and passes it within three inches.
        let mut bench = under_way(90);
        assert_eq!(bench.stop(), 2);
        let along = frame_of("HOME").position - bench.world.frame.position;
        let across = along.cross(&Vector::new(0.0, 0.0, 1.0)).normalize();
        nudge(&mut bench, by_hand, |frame| frame.position += across * aside);
        assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), end, "{aside} in");
    }
    // Off its way and at a known location, the search finds the robot.
    for by_hand in [true, false] {
        let mut bench = under_way(90);
        bench.stop();
        nudge(&mut bench, by_hand, |frame| *frame = frame_of("BENCH"));
        bench.stop();
        assert_eq!(bench.at(), "BENCH");
        assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), DONE, "{by_hand}");
    }
}

#[test]
fn robot_off_its_path_returns_to_it_first() {
    for aside in [0.1, 0.3, -2.0] {
        // On the first leg no point has been passed.
        let mut bench = under_way(20);
        let before = bench.world.frame.position;
        bench.step();
        let along = (bench.world.frame.position - before).normalize();
        bench.stop();
        let left = bench.world.frame.position;
        let across = along.cross(&Vector::new(0.0, 0.0, 1.0)).normalize();
        nudge(&mut bench, true, |frame| frame.position += across * aside);
        bench.send((MovToLoc, "", 0, "VISE", 0));
        let mut stopped = false;
        for _ in 0..200 {
            bench.step();
            let offset = bench.world.frame.position - left;
            let beside = (offset - along * along.dot(&offset)).norm();
            stopped = beside < 0.02 && bench.memory.prim.status.report == PrimReport::Done;
            assert!(along.dot(&offset).abs() < 0.1, "{aside}: {offset:?}");
            if stopped {
                break;
            }
        }
        assert!(stopped, "{aside}");
        assert_eq!(bench.finish(), DONE, "{aside}");
    }
}

/// A link failure made by `cut` stops the robot short of its goal, or off its path. The repeated command must
/// continue.
fn stopped_short(cut: impl Fn(&mut Bench)) {
    for (short, aside, end) in
        [(1.5, 0.0, DONE), (1.5, 4.5, error(Reason::UnknownStart)), (4.0, 0.0, error(Reason::UnknownStart))]
    {
        let mut bench = under_way(90);
        let heading = bench.world.frame.position;
        bench.step();
        let along = (bench.world.frame.position - heading).normalize();
        let across = along.cross(&Vector::new(0.0, 0.0, 1.0)).normalize();
        cut(&mut bench);
        bench.world.frame.position += across * aside - along * short;
        bench.stop();
        assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), end, "{short} in short, {aside} in aside");
    }
}

#[test]
fn robot_stopped_short_by_a_lost_link_keeps_its_path() {
    stopped_short(|bench| {
        (bench.world.prim.report, bench.world.prim.reason) = (PrimReport::T3LinkOff, Reason::LinkOff);
        assert_eq!(bench.finish(), error(Reason::LinkOff));
    });
}

#[test]
fn robot_stopped_before_a_passed_point_keeps_its_path() {
    let mut bench = Bench::ready("HOME", 1);
    bench.world.prim.by_steps = true;
    bench.send((MovToObj, "BLOCK", 1, "BENCH", 1));
    let mut passed = Vec::new();
    while !bench.motions().iter().any(|motion| motion.starts_with("GOTO-PT")) {
        passed.push(bench.world.frame);
        bench.step();
    }
    (bench.world.prim.report, bench.world.prim.reason) = (PrimReport::T3LinkOff, Reason::LinkOff);
    assert_eq!(bench.finish(), error(Reason::LinkOff));
    bench.world.frame = passed[passed.len() - 5];
    bench.stop();
    assert_eq!(bench.run(MovToObj, "BLOCK", 1, "BENCH", 1), DONE, "{:?}", bench.motions());
}

#[test]
fn robot_that_moved_while_emove_was_held_keeps_its_path() {
    let bench = loaded();
    let mut farther = 0;
    for mut fork in bench.during(TO_VISE) {
        let before = fork.world.frame.position;
        fork.sleep(30);
        // A held process does not see the ticks that it has missed.
        farther += u32::from((fork.world.frame.position - before).norm() > 2.0);
        let told = fork.stop();
        assert_eq!(fork.perform(TO_VISE), DONE, "{told} points were sent: {:?}", fork.world.log);
    }
    assert!(farther > 5, "{farther}");
}

#[test]
fn robot_stopped_short_by_a_restarted_link_keeps_its_path() {
    stopped_short(|bench| {
        bench.world.prim.restarts = true;
        bench.wait(3);
        bench.world.prim.restarts = false;
    });
}

#[test]
fn unlocked_ring_refuses_every_motion() {
    let mut bench = Bench::ready("VISE", 1);
    bench.world.locked = false;
    for &line in ORDINARY {
        assert_eq!(bench.perform(line), error(Reason::RingNotLocked), "{}", line.0);
        assert!(bench.log().is_empty());
    }
    bench.world.locked = true;
    assert_eq!(bench.run(MovToLoc, "", 0, "HOLSTER-R", 0), error(Reason::HolsterOnly));
    assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), DONE);
}

#[test]
fn motion_begins_at_the_place_of_the_robot() {
    let row = |robot, goal, back, leg| {
        let decision = resume((), &MotionStart { robot, goal, back, leg });
        (decision.row, decision.action)
    };
    for &goal in GoalOf::ALL {
        for &back in ReturnPath::ALL {
            for &leg in CurrentLeg::ALL {
                let another = match (leg, back) {
                    (CurrentLeg::Depart, _) => (5, MotionBeginning::GoOut),
                    (CurrentLeg::Later, ReturnPath::Free) => (6, MotionBeginning::GoBack),
                    (CurrentLeg::Later, ReturnPath::Closed) => (7, MotionBeginning::RefuseBack),
                };
                let on_way = if goal == GoalOf::Way { (4, MotionBeginning::GoOn) } else { another };
                let here = goal == GoalOf::Place;
                let at_place = if here { (2, MotionBeginning::Settle) } else { (1, MotionBeginning::Depart) };
                assert_eq!(row(EmoveRobot::AtPlace, goal, back, leg), at_place);
                assert_eq!(row(EmoveRobot::Lost, goal, back, leg), (3, MotionBeginning::RefuseStart));
                assert_eq!(row(EmoveRobot::OnWay, goal, back, leg), on_way);
            }
        }
    }
}
