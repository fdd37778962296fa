//! Motions that are interrupted and sent again, or followed by another command (docs/design/recovery.md
//! "On the way", "Replaced", "Beliefs").

use geometry::frame::{Frame, Vector};
use interfaces::{
    Reason, StatusReport,
    emove::{
        Beliefs,
        EmoveVerb::{self, LocateObj, MovObjTo, MovToLoc, MovToObj, MovToVu, Pause, QcAttach, Release},
    },
    prim::{PrimReport, PrimVerb},
};

use super::{
    bench::{Bench, DONE, error, frame_of, moved},
    doubles::Mishap,
};
use crate::emove::{
    Emove,
    tables::resume::{Beginning, GoalOf, LegNow, Robot, Start, WayBack, resume},
};

pub const SCENARIOS: &[fn()] = &[
    a_motion_goes_on_to_the_same_goal_from_every_tick,
    another_goal_is_gone_to_by_the_end_of_the_depart_leg,
    the_place_left_is_gone_to_by_its_own_approach,
    a_way_between_two_poses_at_an_object_leads_only_on,
    a_new_command_stops_what_is_under_way_before_it_is_answered,
    a_nudge_in_the_corridor_leaves_the_robot_on_its_way,
    a_gripper_on_an_open_ring_goes_nowhere,
    a_robot_that_a_lost_link_stopped_short_is_on_its_way,
    a_link_that_is_lost_behind_a_point_may_stop_the_robot_before_it,
    a_robot_that_moved_while_emove_was_held_is_on_its_way,
    a_robot_whose_link_began_anew_short_of_its_point_is_on_its_way,
    without_subtask_everything_stops,
];

type Command<'a> = (EmoveVerb, &'a str, i32, &'a str, u8);

const TO_VISE: Command<'_> = (MovObjTo, "BLOCK", 1, "VISE", 1);
const TO_HOME: Command<'_> = (MovToLoc, "", 0, "HOME", 0);

/// E-PAUSE, at once. How many motions Prim was told of before.
pub fn paused(bench: &mut Bench) -> usize {
    bench.write(Pause, "", 0, "", 0);
    assert_eq!(bench.finish(), DONE, "{:?}", bench.world.log);
    let told = bench.motions().len();
    bench.world.log.clear();
    told
}

pub fn send(
    bench: &mut Bench,
    (verb, object, grip, location, gripper): Command<'_>,
) -> (StatusReport, Reason) {
    bench.run(verb, object, grip, location, gripper)
}

/// A robot at the bench with a block in its fingers.
fn loaded() -> Bench {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.run(MovToObj, "BLOCK", 1, "BENCH", 1), DONE);
    bench.hold("BLOCK", 75, 1);
    bench.prim.by_steps = true;
    bench
}

/// E-move is restarted; its output buffers stay.
fn restart(bench: &mut Bench) {
    bench.process = Emove::default();
    assert_eq!(bench.finish(), error(Reason::Restarted));
}

/// The end of the depart leg of a robot at the bench with a block.
fn departed() -> Frame {
    moved(frame_of("BENCH"), &["GRASP-MTB", "A/D-5"])
}

/// Run a command to its end. How near the robot came to a frame, in.
fn nearest(bench: &mut Bench, (verb, object, grip, location, gripper): Command<'_>, frame: &Frame) -> f64 {
    bench.command(verb, object, grip, location, gripper);
    let mut nearest = f64::INFINITY;
    for _ in 0..1000 {
        nearest = nearest.min(bench.world.frame.distance(frame).inches);
        bench.step();
        let status = bench.memory.emove.status;
        if status.echo == bench.memory.subtask.emove.number && status.report != StatusReport::Executing {
            assert_eq!((status.report, status.reason), DONE, "{:?}", bench.world.log);
            return nearest;
        }
    }
    panic!("never over: {:?}", bench.world.log);
}

#[test]
fn a_motion_goes_on_to_the_same_goal_from_every_tick() {
    for restarts in [false, true] {
        let mut bench = loaded();
        let full = ["GO-THRU A/D-5", "GO-THRU", "GO-THRU A/D-5", "GOTO-PT"];
        let mut seen = [0; 5];
        bench.at_every_tick(TO_VISE, |fork| {
            if restarts {
                restart(fork);
            }
            let told = paused(fork);
            assert_eq!(send(fork, TO_VISE), DONE, "{told}");
            let again = fork.motions();
            let rest = if again.is_empty() { &[] } else { &full[told.saturating_sub(1)..] };
            assert_eq!(again, rest, "no point twice, {told} told");
            assert!(fork.off(&moved(frame_of("VISE"), &["GRASP-MTB"])) < 0.02);
            let status = fork.memory.emove.status;
            assert_eq!(status.at.unwrap_or_default().site.location.as_str(), "VISE");
            assert_eq!(status.held.object().unwrap_or_default().as_str(), "BLOCK");
            seen[told] += 1;
        });
        assert_eq!(bench.motions(), full);
        assert!(seen[1..].iter().all(|ticks| *ticks > 0), "in every leg: {seen:?}");
    }
}

#[test]
fn another_goal_is_gone_to_by_the_end_of_the_depart_leg() {
    let mut bench = loaded();
    let taken = moved(frame_of("BENCH"), &["GRASP-MTB"]);
    let mut seen = [0; 5];
    bench.at_every_tick(TO_VISE, |fork| {
        let told = paused(fork);
        if fork.memory.emove.status.at.is_some() {
            return;
        }
        let from = fork.world.frame.distance(&taken).inches;
        let near = nearest(fork, TO_HOME, &taken);
        let back = vec!["GO-THRU"; told.saturating_sub(1)];
        let then = if told == 1 { vec!["GO-THRU A/D-5"] } else { back };
        let then = then.into_iter().chain(["GO-THRU", "GOTO-PT"]).collect::<Vec<_>>();
        assert_eq!(fork.motions(), then, "{told} told");
        assert!(fork.off(&frame_of("HOME")) < 0.02);
        // Points are passed within an inch.
        assert!(near > from.min(5.0) - 1.1, "{near} in: it does not go back into the depart leg");
        seen[told] += 1;
    });
    assert!(seen[1..].iter().all(|ticks| *ticks > 0), "in every leg: {seen:?}");
    // Interrupted a second time, on the way back, it still knows the way.
    for ticks in (10..300).step_by(29) {
        for later in (5..120).step_by(17) {
            let mut bench = loaded();
            bench.write(TO_VISE.0, TO_VISE.1, 1, TO_VISE.3, 1);
            bench.steps(ticks);
            paused(&mut bench);
            bench.write(TO_HOME.0, "", 0, TO_HOME.3, 0);
            bench.steps(later);
            paused(&mut bench);
            let near = nearest(&mut bench, TO_VISE, &departed());
            assert!(bench.off(&moved(frame_of("VISE"), &["GRASP-MTB"])) < 0.02, "{ticks} {later} {near}");
        }
    }
}

#[test]
fn the_place_left_is_gone_to_by_its_own_approach() {
    let mut bench = loaded();
    bench.at_every_tick(TO_VISE, |fork| {
        let told = paused(fork);
        let left = fork.memory.emove.status.at.is_none();
        assert_eq!(send(fork, (MovObjTo, "BLOCK", 1, "BENCH", 1)), DONE);
        assert!(fork.off(&moved(frame_of("BENCH"), &["GRASP-MTB"])) < 0.02);
        if left && told > 1 {
            let back = vec!["GO-THRU"; told - 1];
            let then = back.into_iter().chain(["GO-THRU A/D-5", "GOTO-PT"]).collect::<Vec<_>>();
            assert_eq!(fork.motions(), then);
        }
    });
    // A robot that was to open its fingers for the goal orders it again when it is due.
    let mut bench = Bench::ready("HOME", 1);
    bench.prim.by_steps = true;
    bench.at_every_tick((MovToObj, "BLOCK", 1, "BENCH", 1), |fork| {
        paused(fork);
        assert_eq!(send(fork, (MovToObj, "BLOCK", 1, "BENCH", 1)), DONE);
        assert_eq!(fork.grip.opening, 300, "{:?}", fork.world.log);
    });
    // The camera over a part goes on, or back to the view.
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.run(MovToVu, "BLOCK", 1, "BENCH", 1), DONE);
    bench.prim.by_steps = true;
    bench.at_every_tick((LocateObj, "BLOCK", 1, "BENCH", 1), |fork| {
        paused(fork);
        for verb in [MovToVu, LocateObj, MovToObj] {
            assert_eq!(send(fork, (verb, "BLOCK", 1, "BENCH", 1)), DONE, "{verb} {:?}", fork.world.log);
        }
        assert_eq!(send(fork, TO_HOME), DONE);
    });
}

#[test]
fn a_way_between_two_poses_at_an_object_leads_only_on() {
    let to_block = (MovToObj, "BLOCK", 1, "BENCH", 1);
    let to_pin = (MovToObj, "PIN", 1, "BENCH", 1);
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(send(&mut bench, to_pin), DONE);
    // A pin that lies two inches farther is still the same place; it has no depart points.
    bench.prim.by_steps = true;
    let further = |bench: &mut Bench| {
        bench.write(to_pin.0, to_pin.1, 1, to_pin.3, 1);
        let record = &mut bench.memory.subtask.poses[0];
        record.pose = geometry::pose::Pose::from_frame(&moved(frame_of("BENCH"), &["300ty"]));
    };
    further(&mut bench);
    bench.steps(8);
    paused(&mut bench);
    for other in [TO_HOME, to_block, to_pin] {
        assert_eq!(send(&mut bench, other), error(Reason::ForwardOnly));
        assert_eq!(bench.motions(), [""; 0], "nothing moves");
    }
    further(&mut bench);
    assert_eq!(bench.finish(), DONE);
    assert!(bench.off(&moved(frame_of("BENCH"), &["300ty", "GRASP-MTB"])) < 0.02);
    // From the place as such, or from a view, there is a way back.
    for (verb, gripper) in [(MovToLoc, 1), (MovToVu, 1)] {
        let mut bench = Bench::ready("HOME", gripper);
        assert_eq!(bench.run(verb, "BLOCK", 1, "BENCH", 1), DONE);
        bench.prim.by_steps = true;
        bench.write(to_pin.0, to_pin.1, 1, to_pin.3, 1);
        bench.steps(6);
        paused(&mut bench);
        assert_eq!(send(&mut bench, TO_HOME), DONE, "{verb}");
    }
}

/// E-PAUSE brings all to rest itself; every other command waits until all is at rest, whether it is accepted
/// or refused.
#[test]
fn a_new_command_stops_what_is_under_way_before_it_is_answered() {
    for (next, end) in [
        (TO_HOME, DONE),
        ((MovToLoc, "", 0, "", 0), error(Reason::NoDestination)),
        ((MovToObj, "BLOCK", 7, "BENCH", 1), error(Reason::UnknownGrip)),
        ((Release, "BLOCK", 1, "VISE", 1), DONE),
    ] {
        let mut bench = loaded();
        bench.at_every_tick(TO_VISE, |fork| {
            let prim = &fork.memory.prim.status;
            let moving = prim.echo != fork.memory.emove.prim.number || prim.report == PrimReport::Executing;
            let before = fork.world.log.len();
            let (verb, object, grip, location, gripper) = next;
            fork.write(verb, object, grip, location, gripper);
            assert_eq!(fork.finish(), end, "{:?}", fork.world.log);
            // What was ordered in the tick before is on its way to Prim.
            let at = fork.log()[before..].iter().position(|text| *text == "PAUSE");
            assert!(!moving || at.is_some_and(|at| at <= 1), "{:?}", fork.world.log);
            let there = fork.world.frame;
            fork.steps(5);
            assert!(fork.off(&there) < 0.01, "it is at rest when the end is reported");
        });
    }
}

/// A command that is found after a restart is not executed, and what was ordered for it is stopped.
#[test]
fn a_restarted_e_move_stops_what_it_had_ordered() {
    let mut bench = loaded();
    bench.at_every_tick(TO_VISE, |fork| {
        let (prim, sent) = (fork.memory.prim.status, fork.memory.emove.prim);
        let arrived =
            prim.echo == sent.number && prim.report == PrimReport::Done && sent.command == PrimVerb::GotoPt;
        restart(fork);
        fork.steps(2);
        assert!(arrived || fork.memory.emove.prim.command == PrimVerb::Pause);
        let there = fork.world.frame;
        fork.steps(5);
        assert!(fork.off(&there) < 0.01, "it stands");
    });
    // The operator who has the robot keeps it.
    let mut bench = Bench::ready("HOME", 1);
    bench.spoil("GO-THRU", Mishap::Joystick);
    assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), (StatusReport::JoystickOn, Reason::JoystickOn));
    let sent = bench.memory.emove.prim.number;
    bench.process = Emove::default();
    bench.steps(5);
    assert_eq!(bench.memory.emove.prim.number, sent, "nothing is sent");
}

/// Nothing that Subtask has commanded goes on without it.
#[test]
fn without_subtask_everything_stops() {
    let mut bench = loaded();
    bench.at_every_tick(TO_VISE, |fork| {
        let was_executing = fork.memory.emove.status.report == StatusReport::Executing;
        fork.dead.push("Subtask");
        fork.steps(60);
        let there = fork.world.frame;
        fork.steps(5);
        assert!(fork.off(&there) < 0.01, "it stands");
        let status = fork.memory.emove.status;
        if was_executing {
            let ended = (status.report, status.reason);
            assert!([error(Reason::NeighbourLost), (StatusReport::Done, Reason::None)].contains(&ended));
        }
    });
}

#[test]
fn a_restarted_e_move_believes_what_it_believed() {
    let beliefs = |bench: &Bench| {
        let Beliefs { place, held, placed, located, exchange, .. } = bench.memory.emove.beliefs;
        (place, held, placed, located, exchange)
    };
    // Before the grasp what vision has located, after it what is held, and then what was let go.
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
        let before = beliefs(&bench);
        restart(&mut bench);
        assert_eq!(beliefs(&bench), before, "after {verb}");
        paused(&mut bench);
        assert_eq!(beliefs(&bench), before, "after {verb}");
    }
    assert!(bench.memory.emove.status.placed.is_some());
    // What the sensors contradict is not believed.
    let mut bench = loaded();
    bench.dead.push("E-move");
    bench.world.frame = frame_of("HOME");
    bench.grip.opening = 200;
    bench.world.object = None;
    bench.steps(3);
    bench.dead.clear();
    restart(&mut bench);
    let status = bench.memory.emove.status;
    assert_eq!((status.at.is_some(), status.held.is_held()), (false, false));
    // A change of a gripper is one of the beliefs.
    let mut bench = Bench::ready("HOLSTER-R", 1);
    bench.world.frame = moved(frame_of("HOLSTER-R"), &["QCA-LIFT"]);
    bench.prim.by_steps = true;
    bench.command(QcAttach, "GRIPPER-1", 2, "HOLSTER-R", 1);
    bench.steps(8);
    restart(&mut bench);
    assert_eq!(bench.memory.emove.status.exchange, Some(1));
}

#[test]
fn a_nudge_in_the_corridor_leaves_the_robot_on_its_way() {
    for (aside, by_hand, end) in [
        (0.4, false, DONE),
        (0.6, false, error(Reason::UnknownStart)),
        (2.5, true, DONE),
        (-2.5, true, DONE),
        (4.5, true, error(Reason::UnknownStart)),
    ] {
        // To the second point of the way from HOME, which is passed within three inches.
        let mut bench = Bench::ready("HOME", 0);
        bench.prim.by_steps = true;
        bench.write(MovToLoc, "", 0, "VISE", 0);
        bench.steps(90);
        assert_eq!(paused(&mut bench), 2);
        bench.world.joystick = by_hand;
        bench.steps(4);
        let heading = moved(frame_of("HOME"), &[]).position;
        let along = heading - bench.world.frame.position;
        let across = along.cross(&Vector::new(0.0, 0.0, 1.0)).normalize();
        bench.world.frame.position += across * aside;
        bench.steps(4);
        bench.world.joystick = false;
        bench.steps(8);
        assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), end, "{aside} in");
    }
    // Off its way and at a known location: the search finds it there.
    for by_hand in [true, false] {
        let mut bench = Bench::ready("HOME", 0);
        bench.prim.by_steps = true;
        bench.write(MovToLoc, "", 0, "VISE", 0);
        bench.steps(90);
        paused(&mut bench);
        bench.world.joystick = by_hand;
        bench.steps(4);
        bench.world.frame = frame_of("BENCH");
        bench.steps(4);
        bench.world.joystick = false;
        bench.steps(8);
        paused(&mut bench);
        assert_eq!(bench.memory.emove.status.at.unwrap_or_default().site.location.as_str(), "BENCH");
        assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), DONE, "{by_hand}");
    }
}

#[test]
fn a_robot_beside_its_way_comes_back_to_it_first() {
    for aside in [0.1, 0.3, -2.0] {
        let mut bench = Bench::ready("HOME", 0);
        bench.prim.by_steps = true;
        bench.write(MovToLoc, "", 0, "VISE", 0);
        // On the first leg: no point was passed beside yet.
        bench.steps(20);
        let before = bench.world.frame.position;
        bench.steps(1);
        let along = (bench.world.frame.position - before).normalize();
        paused(&mut bench);
        bench.world.joystick = true;
        bench.steps(4);
        let left = bench.world.frame.position;
        bench.world.frame.position += along.cross(&Vector::new(0.0, 0.0, 1.0)).normalize() * aside;
        bench.steps(4);
        bench.world.joystick = false;
        bench.steps(8);
        bench.write(MovToLoc, "", 0, "VISE", 0);
        let mut stopped = false;
        for _ in 0..200 {
            bench.steps(1);
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

/// What `cut` makes of the link stops the robot short of where it was sent, or aside: does the command sent again
/// go on?
fn stopped_short(cut: impl Fn(&mut Bench)) {
    for (short, aside, end) in
        [(1.5, 0.0, DONE), (1.5, 4.5, error(Reason::UnknownStart)), (4.0, 0.0, error(Reason::UnknownStart))]
    {
        let mut bench = Bench::ready("HOME", 0);
        bench.prim.by_steps = true;
        bench.write(MovToLoc, "", 0, "VISE", 0);
        bench.steps(90);
        let heading = bench.world.frame.position;
        bench.steps(1);
        let along = (bench.world.frame.position - heading).normalize();
        let across = along.cross(&Vector::new(0.0, 0.0, 1.0)).normalize();
        cut(&mut bench);
        bench.world.frame.position += across * aside - along * short;
        paused(&mut bench);
        assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), end, "{short} in short, {aside} in aside");
    }
}

#[test]
fn a_robot_that_a_lost_link_stopped_short_is_on_its_way() {
    stopped_short(|bench| {
        (bench.prim.report, bench.prim.reason) = (PrimReport::T3LinkOff, Reason::LinkOff);
        assert_eq!(bench.finish(), error(Reason::LinkOff));
    });
}

#[test]
fn a_link_that_is_lost_behind_a_point_may_stop_the_robot_before_it() {
    let mut bench = Bench::ready("HOME", 1);
    bench.prim.by_steps = true;
    bench.write(MovToObj, "BLOCK", 1, "BENCH", 1);
    let mut passed = Vec::new();
    while !bench.motions().iter().any(|motion| motion.starts_with("GOTO-PT")) {
        passed.push(bench.world.frame);
        bench.step();
    }
    (bench.prim.report, bench.prim.reason) = (PrimReport::T3LinkOff, Reason::LinkOff);
    assert_eq!(bench.finish(), error(Reason::LinkOff));
    bench.world.frame = passed[passed.len() - 5];
    paused(&mut bench);
    assert_eq!(bench.run(MovToObj, "BLOCK", 1, "BENCH", 1), DONE, "{:?}", bench.motions());
}

#[test]
fn a_robot_that_moved_while_emove_was_held_is_on_its_way() {
    let mut bench = loaded();
    let mut farther = 0;
    bench.at_every_tick(TO_VISE, |fork| {
        let before = fork.world.frame.position;
        fork.dead.push("E-move");
        fork.steps(30);
        fork.dead.clear();
        // A held process does not see the ticks that it has missed.
        farther += u32::from((fork.world.frame.position - before).norm() > 2.0);
        let told = paused(fork);
        assert_eq!(send(fork, TO_VISE), DONE, "{told} told: {:?}", fork.world.log);
    });
    assert!(farther > 5, "{farther}");
}

#[test]
fn a_robot_whose_link_began_anew_short_of_its_point_is_on_its_way() {
    stopped_short(|bench| {
        bench.prim.restarts = true;
        bench.steps(3);
        bench.prim.restarts = false;
    });
}

#[test]
fn a_gripper_on_an_open_ring_goes_nowhere() {
    use EmoveVerb::{AcquireTool, GraspObj, InsertTool, MovToHol, ReleaseTool, RemoveTool, Withdraw};
    let mut bench = Bench::ready("HOME", 1);
    bench.world.locked = false;
    for (verb, object, location) in [
        (MovToLoc, "", "VISE"),
        (MovToObj, "BLOCK", "BENCH"),
        (MovObjTo, "BLOCK", "BENCH"),
        (MovToVu, "BLOCK", "BENCH"),
        (MovToHol, "GRIPPER-1", "HOLSTER-R"),
        (Withdraw, "", "BENCH"),
        (LocateObj, "BLOCK", "BENCH"),
        (GraspObj, "BLOCK", "BENCH"),
        (InsertTool, "CUTTER", "TOOL-TRNS"),
        (ReleaseTool, "CUTTER", "TOOL-TRNS"),
        (AcquireTool, "CUTTER", "TOOL-TRNS"),
        (RemoveTool, "CUTTER", "TOOL-TRNS"),
    ] {
        assert_eq!(bench.run(verb, object, 1, location, 1), error(Reason::RingNotLocked), "{verb}");
        assert!(bench.log().is_empty());
    }
    bench.world.locked = true;
    assert_eq!(bench.run(MovToLoc, "", 0, "HOLSTER-R", 0), error(Reason::HolsterOnly));
    assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), DONE);
}

#[test]
fn a_motion_begins_where_the_robot_is() {
    let row = |robot, goal, back, leg| {
        let decision = resume((), &Start { robot, goal, back, leg });
        (decision.row, decision.action)
    };
    for &goal in GoalOf::ALL {
        for &back in WayBack::ALL {
            for &leg in LegNow::ALL {
                let another = match (leg, back) {
                    (LegNow::Depart, _) => (5, Beginning::GoOut),
                    (LegNow::Later, WayBack::Free) => (6, Beginning::GoBack),
                    (LegNow::Later, WayBack::Closed) => (7, Beginning::RefuseBack),
                };
                let on_way = if goal == GoalOf::Way { (4, Beginning::GoOn) } else { another };
                let here = goal == GoalOf::Place;
                let at_place = if here { (2, Beginning::Settle) } else { (1, Beginning::Depart) };
                assert_eq!(row(Robot::AtPlace, goal, back, leg), at_place);
                assert_eq!(row(Robot::Lost, goal, back, leg), (3, Beginning::RefuseStart));
                assert_eq!(row(Robot::OnWay, goal, back, leg), on_way);
            }
        }
    }
}
