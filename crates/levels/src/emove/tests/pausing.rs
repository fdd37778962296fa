//! E-PAUSE: the start, the dormancy of the gripper processes, and the joystick box.

use interfaces::{
    Reason, StatusReport,
    emove::{
        Dormancy,
        EmoveVerb::{GraspObj, LocateObj, MovToLoc, Pause, QcDetach, Release},
    },
    jaws::JawsReport,
    prim::{JoystickGrip, PrimReport},
    quick_change::{QuickChangeReport, RingPosition},
};
use rcs_core::table::Verdict;

use super::{
    bench::{Bench, DONE, error, frame_of, given, moved},
    doubles::Mishap,
};
use crate::{
    emove::tables::{
        self, Action, Knowledge, PlaceKnowledge, Watch,
        attend::attend,
        search::{Look, search},
    },
    execution::Outcome,
};

pub const SCENARIOS: &[fn()] = &[
    the_first_pause_brings_the_link_up,
    every_gripper_and_none_can_be_on_at_the_start,
    a_pause_waits_for_the_calibration,
    only_the_process_of_the_attached_gripper_runs,
    a_pause_that_fails_says_why,
    a_ring_that_stands_half_way_is_at_rest,
    fingers_do_what_they_were_told_before_they_pause,
    the_robot_is_found_where_it_stands,
    the_operator_moves_the_robot_and_the_fingers,
    the_operator_interrupts_a_command,
    robot_given_back_by_the_operator_is_done_when_everything_rests,
    nothing_begins_while_the_operator_has_the_robot,
    a_restarted_e_move_executes_nothing,
    a_link_that_fails_in_a_pause_is_initialized_again_or_reported,
];

#[test]
fn a_link_that_fails_in_a_pause_is_initialized_again_or_reported() {
    // The gripper is not calibrated yet.
    let mut bench = Bench::new("HOME", 1);
    bench.spoil("PAUSE", Mishap::Never);
    bench.command(Pause, "", 0, "", 0);
    bench.steps(40);
    (bench.prim.report, bench.prim.reason) = (PrimReport::T3LinkErr, Reason::LinkError);
    let before = bench.log().len();
    bench.steps(40);
    assert_eq!(bench.log()[before..before + 2], ["ROBOT-INIT", "PAUSE"]);
    assert_eq!(bench.memory.emove.status.report, StatusReport::Executing);
    let mut again = bench.clone();
    (again.prim.report, again.prim.reason) = (PrimReport::T3LinkErr, Reason::LinkError);
    assert_eq!(again.finish(), error(Reason::LinkError), "not a third time");
    bench.dead.push("Prim");
    assert_eq!(bench.finish(), error(Reason::NeighbourLost));
    // The pause is done and stands.
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.pause(), DONE);
    (bench.prim.report, bench.prim.reason) = (PrimReport::T3LinkErr, Reason::LinkError);
    bench.steps(3);
    let status = &bench.memory.emove.status;
    assert_eq!(
        (status.report, status.reason),
        (StatusReport::Done, Reason::LinkError),
        "no failure of E-PAUSE"
    );
    assert_eq!(bench.pause(), DONE);
}

#[test]
fn a_person_lets_prim_initialize_the_link_while_the_pause_stands() {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.pause(), DONE);
    bench.world.log.clear();
    bench.external.operator.robot_init = 7;
    bench.steps(40);
    assert_eq!(bench.log(), ["ROBOT-INIT", "PAUSE", "QC-PAUSE"]);
    assert_eq!(bench.memory.emove.status.report, StatusReport::Done, "what is done stays done");
    // An E-move that starts again does not obey it once more.
    bench.process = crate::emove::Emove::default();
    assert_eq!(bench.finish(), error(Reason::Restarted));
    assert_eq!(bench.pause(), DONE);
    bench.world.log.clear();
    bench.steps(40);
    assert!(bench.log().is_empty(), "{:?}", bench.log());
}

#[test]
fn the_first_pause_brings_the_link_up() {
    let mut bench = Bench::new("HOME", 1);
    assert_eq!(bench.pause(), DONE);
    assert_eq!(bench.log(), ["ROBOT-INIT", "PAUSE", "QC-PAUSE", "PAUSE"], "Prim, Quick Change, Grip");
    assert_eq!(bench.pause(), DONE);
    assert!(!bench.log().contains(&"ROBOT-INIT"), "it runs");
}

#[test]
fn every_gripper_and_none_can_be_on_at_the_start() {
    for gripper in 0..=3 {
        let mut bench = Bench::new("HOME", gripper);
        // Fingers on something of any size are not the pause's business.
        (bench.v_grip.opening, bench.tool_grip.opening) = (200, 200);
        assert_eq!(bench.pause(), DONE);
        assert_eq!(bench.memory.emove.status.end_effector_id, given(gripper));
    }
}

#[test]
fn a_pause_waits_for_the_calibration() {
    let mut bench = Bench::new("HOME", 1);
    bench.spoil("PAUSE", Mishap::Never);
    bench.command(Pause, "", 0, "", 0);
    bench.steps(200);
    assert_eq!(bench.memory.prim.status.report, PrimReport::Done);
    assert_eq!(bench.memory.emove.status.report, StatusReport::Executing, "Grip's PAUSE is not done before");
}

#[test]
fn only_the_process_of_the_attached_gripper_runs() {
    let all = Dormancy { grip: true, v_grip: true, tool_grip: true };
    for (gripper, dormant) in [
        (0, all),
        (1, Dormancy { grip: false, ..all }),
        (2, Dormancy { v_grip: false, ..all }),
        (3, Dormancy { tool_grip: false, ..all }),
    ] {
        let mut bench = Bench::new("HOME", 0);
        bench.world.mated = gripper;
        bench.steps(2);
        assert_eq!(bench.memory.emove.dormant, dormant, "gripper {gripper}, without any command");
    }
}

#[test]
fn a_pause_that_fails_says_why() {
    let mut bench = Bench::new("HOME", 1);
    bench.spoil("QC-PAUSE", Mishap::Ring(QuickChangeReport::SensorMalfunction));
    assert_eq!(bench.pause(), error(Reason::QuickChangeFault));
    let mut bench = Bench::new("HOME", 1);
    bench.command(Pause, "", 0, "", 0);
    bench.steps(10);
    bench.dead.push("Quick Change");
    assert_eq!(bench.finish(), error(Reason::NeighbourLost));
    let mut bench = Bench::new("HOME", 2);
    bench.command(Pause, "", 0, "", 0);
    bench.steps(10);
    bench.dead.push("gripper");
    assert_eq!(bench.finish(), error(Reason::NeighbourLost));
    let mut bench = Bench::ready("HOME", 1);
    bench.command(Pause, "", 0, "", 0);
    bench.steps(3);
    bench.dead.push("Prim");
    assert_eq!(bench.finish(), error(Reason::NeighbourLost));
    let mut bench = Bench::new("HOME", 1);
    bench.spoil("ROBOT-INIT", Mishap::Prim(PrimReport::T3LinkOff, Reason::LinkOff));
    assert_eq!(bench.pause(), error(Reason::LinkOff));
    let mut bench = Bench::new("HOME", 1);
    bench.spoil("ROBOT-INIT", Mishap::Joystick);
    assert_eq!(bench.pause().1, Reason::JoystickOn);
    let mut bench = Bench::new("HOME", 1);
    bench.command(Pause, "", 0, "", 0);
    bench.steps(3);
    bench.world.mated = 2;
    assert_eq!(bench.finish(), DONE, "a gripper that has come since is not waited for");
}

#[test]
fn a_ring_that_stands_half_way_is_at_rest() {
    let mut bench = Bench::new("HOME", 1);
    bench.spoil("QC-PAUSE", Mishap::Ring(QuickChangeReport::Stuck));
    assert_eq!(bench.pause(), DONE);
    assert_eq!(bench.memory.quick_change.status.ring, RingPosition::Between);
    assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), error(Reason::RingNotLocked));
}

#[test]
fn fingers_do_what_they_were_told_before_they_pause() {
    for (gripper, object, size) in [(1, "BLOCK", 75), (2, "SHAFT", 200), (3, "CUTTER", 250)] {
        let mut bench = Bench::ready("HOME", gripper);
        bench.world.object = Some(size);
        bench.at_every_tick((GraspObj, object, 1, "", gripper), |fork| {
            fork.write(Pause, "", 0, "", 0);
            assert_eq!(fork.finish(), DONE);
            let log = fork.log();
            let closed = log.iter().position(|text| text.contains("CLOSE") || text.contains("GRASP"));
            let paused = log.iter().rposition(|text| text.contains("PAUSE")).unwrap_or_default();
            assert!(closed.is_none_or(|closed| closed < paused), "{log:?}");
            let held = fork.memory.emove.status.held;
            let named = held.object().is_some_and(|held| held.as_str() == object);
            assert!(
                closed.is_none() || named,
                "what they have closed on has the name of the command: {held:?}"
            );
        });
        assert!(bench.memory.emove.status.held.is_held());
    }
}

#[test]
fn the_robot_is_found_where_it_stands() {
    let mut bench = Bench::new("HOLSTER-C", 0);
    assert_eq!(bench.pause(), DONE);
    assert!(bench.memory.emove.status.at.is_none(), "a holster is no plain location");
    bench.world.frame = frame_of("BENCH");
    assert_eq!(bench.pause(), DONE);
    assert_eq!(bench.memory.emove.status.at.unwrap_or_default().site.location.as_str(), "BENCH");
    bench.world.frame = moved(frame_of("HOME"), &["300ty"]);
    assert_eq!(bench.pause(), DONE, "it need not be anywhere");
    assert!(bench.memory.emove.status.at.is_none());
}

/// Only E-PAUSE looks for the robot, and only while it is done or under way.
#[test]
fn the_search_belongs_to_the_pause() {
    let rows = |watch: Watch| (search((), &watch).row, search((), &watch).action);
    let looking = Watch {
        initialization: tables::Initialization::None,
        pause: tables::Pause::UnderWay,
        outcome: Outcome::Executing,
        place: PlaceKnowledge::Searching,
        resolvers: Knowledge::Known,
    };
    for place in [PlaceKnowledge::Known, PlaceKnowledge::Unknown] {
        assert_eq!(rows(Watch { place, ..looking }), (1, Look::Rest));
    }
    assert_eq!(rows(Watch { pause: tables::Pause::Other, ..looking }), (2, Look::Rest));
    assert_eq!(rows(Watch { resolvers: Knowledge::Unknown, ..looking }), (3, Look::Rest));
    for outcome in [Outcome::Idle, Outcome::Error] {
        assert_eq!(rows(Watch { outcome, ..looking }), (4, Look::Rest));
    }
    for outcome in [Outcome::Executing, Outcome::Done, Outcome::Joystick] {
        assert_eq!(rows(Watch { outcome, ..looking }), (5, Look::Look));
        assert_eq!(rows(Watch { outcome, pause: tables::Pause::Standing, ..looking }), (5, Look::Look));
    }
}

/// A pause that stands goes on; a command that has ended does not.
#[test]
fn only_a_standing_pause_goes_on() {
    for &pause in tables::Pause::ALL {
        for &outcome in Outcome::ALL {
            let watch = Watch {
                initialization: tables::Initialization::None,
                pause,
                outcome,
                place: PlaceKnowledge::Known,
                resolvers: Knowledge::Known,
            };
            let goes_on =
                pause == tables::Pause::Standing && matches!(outcome, Outcome::Done | Outcome::Joystick);
            assert_eq!(attend((), &watch) == Verdict::Passed(()), goes_on, "{pause} {outcome}");
            // `.R` initializes the link, then the pause goes on.
            for (initialization, action) in [
                (tables::Initialization::Asked, Action::RobotInit),
                (tables::Initialization::Over, Action::StopRobot),
            ] {
                let expected = if goes_on { action } else { Action::Wait };
                let Verdict::Decided(found) = attend((), &Watch { initialization, ..watch }) else {
                    panic!("{pause} {outcome}: the tables of the commands know nothing of it");
                };
                assert_eq!(found.action, expected, "{pause} {outcome}");
            }
        }
    }
}

#[test]
fn the_operator_moves_the_robot_and_the_fingers() {
    for gripper in 1..=3 {
        let mut bench = Bench::ready("HOME", gripper);
        let (object, size) = [("BLOCK", 75), ("SHAFT", 200), ("CUTTER", 250)][usize::from(gripper) - 1];
        bench.hold(object, size, gripper);
        assert_eq!(bench.pause(), DONE);
        bench.world.joystick = true;
        bench.steps(3);
        let status = bench.memory.emove.status;
        assert_eq!((status.report, status.reason), (StatusReport::JoystickOn, Reason::JoystickOn));
        bench.world.log.clear();
        bench.world.button = JoystickGrip::Open;
        bench.steps(20);
        assert_eq!(bench.log().len(), 1, "pressing counts, not holding down: {:?}", bench.log());
        assert!(!bench.memory.emove.status.held.is_held(), "the fingers are open");
        assert!(bench.memory.emove.status.placed.is_some());
        bench.world.button = JoystickGrip::None;
        bench.steps(3);
        bench.world.button = JoystickGrip::Close;
        bench.steps(20);
        assert_eq!(bench.log().len(), 2);
        assert_eq!(bench.memory.emove.status.placed, None, "it may be between the fingers again");
        let closed = [bench.grip.opening, bench.v_grip.opening, bench.tool_grip.opening];
        assert_eq!(closed[usize::from(gripper) - 1], [10, 50, 100][usize::from(gripper) - 1]);
        // The operator has carried the robot to the vise and gives it back.
        bench.world.frame = frame_of("VISE");
        (bench.world.joystick, bench.world.button) = (false, JoystickGrip::None);
        bench.steps(10);
        let status = bench.memory.emove.status;
        assert_eq!(
            (status.report, status.reason, status.at.unwrap_or_default().site.location.as_str()),
            (StatusReport::Done, Reason::None, "VISE")
        );
    }
    // Without frame switches the buttons work as well, and a robot that is switched over while it pauses is
    // the operator's.
    let mut bench = Bench::ready("HOME", 1);
    bench.world.joystick = true;
    assert_eq!(bench.pause(), (StatusReport::JoystickOn, Reason::JoystickOn));
    bench.world.joystick = false;
    bench.steps(10);
    assert_eq!(bench.memory.emove.status.report, StatusReport::Done);
    bench.dead.push("Prim");
    bench.steps(5);
    assert_eq!(bench.memory.emove.status.report, StatusReport::Done, "done stays");
}

/// The operator gives the robot back while the fingers still move, while the ring still pauses, and with a link that
/// fails; and takes it once more before everything rests.
#[test]
fn robot_given_back_by_the_operator_is_done_when_everything_rests() {
    let led = || {
        let mut bench = Bench::ready("HOME", 2);
        assert_eq!(bench.pause(), DONE);
        bench.world.joystick = true;
        bench.steps(3);
        bench
    };
    let ticks = |bench: &mut Bench| {
        (bench.world.joystick, bench.world.button) = (false, JoystickGrip::None);
        let ticks = (0..40).find(|_| {
            bench.step();
            bench.memory.emove.status.report != StatusReport::JoystickOn
        });
        assert_eq!(bench.memory.emove.status.report, StatusReport::Done);
        ticks.unwrap()
    };
    let at_rest = ticks(&mut led());
    let mut bench = led();
    bench.world.button = JoystickGrip::Open;
    bench.steps(2);
    assert!(ticks(&mut bench) > at_rest, "the fingers open first");
    let mut bench = led();
    bench.spoil("QC-PAUSE", Mishap::Ring(QuickChangeReport::Executing));
    bench.world.joystick = false;
    bench.steps(20);
    assert_eq!(bench.memory.emove.status.report, StatusReport::JoystickOn, "Quick Change never pauses");
    for again in 1..at_rest {
        let mut bench = led();
        bench.world.joystick = false;
        bench.steps(again);
        bench.world.joystick = true;
        bench.steps(4);
        assert_eq!(bench.memory.emove.status.report, StatusReport::JoystickOn, "after {again} ticks");
        ticks(&mut bench);
    }
    let mut bench = led();
    bench.spoil("PAUSE", Mishap::Prim(PrimReport::T3LinkErr, Reason::LinkError));
    ticks(&mut bench);
    assert_eq!(bench.memory.emove.status.reason, Reason::LinkError, "the reason stands beside it");
    let mut bench = led();
    bench.memory.prim.status.report = PrimReport::T3LinkErr;
    bench.dead.push("Prim");
    bench.steps(2);
    assert_eq!(bench.memory.emove.status.report, StatusReport::Done, "the reason stands beside it");
}

#[test]
fn the_operator_interrupts_a_command() {
    let mut bench = Bench::ready("HOME", 1);
    bench.command(MovToLoc, "", 0, "VISE", 0);
    bench.steps(7);
    bench.world.joystick = true;
    assert_eq!(bench.finish(), (StatusReport::JoystickOn, Reason::JoystickOn));
    assert_eq!(bench.pause(), (StatusReport::JoystickOn, Reason::JoystickOn));
    bench.world.joystick = false;
    bench.steps(10);
    assert_eq!(bench.memory.emove.status.report, StatusReport::Done);
    // A command that was interrupted and not followed by a pause ends in an error when the box is let go.
    let mut bench = Bench::ready("HOME", 1);
    bench.spoil("GO-THRU", Mishap::Joystick);
    assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), (StatusReport::JoystickOn, Reason::JoystickOn));
    bench.memory.prim.status.report = PrimReport::Done;
    bench.dead.push("Prim");
    bench.steps(2);
    let status = bench.memory.emove.status;
    assert_eq!((status.report, status.reason), error(Reason::JoystickOn));
}

/// A command that comes in the tick in which the operator takes the robot: fingers and ring stay as they are.
#[test]
fn nothing_begins_while_the_operator_has_the_robot() {
    for (holds, verb, object, location) in [
        (true, Release, "BLOCK", ""),
        (true, MovToLoc, "", "VISE"),
        (true, QcDetach, "GRIPPER-1", "HOLSTER-R"),
        (false, GraspObj, "BLOCK", ""),
        (false, LocateObj, "BLOCK", "BENCH"),
    ] {
        let mut bench = Bench::ready("HOME", 1);
        if holds {
            bench.hold("BLOCK", 75, 1);
        }
        bench.world.log.clear();
        bench.world.joystick = true;
        assert_eq!(
            bench.run(verb, object, 1, location, 1),
            (StatusReport::JoystickOn, Reason::JoystickOn),
            "{verb}"
        );
        bench.world.joystick = false;
        bench.steps(5);
        let status = bench.memory.emove.status;
        assert_eq!((status.report, status.reason), error(Reason::JoystickOn), "{verb}");
        assert_eq!(status.held.is_held(), holds, "{verb}");
        assert!(bench.log().is_empty(), "{verb}: {:?}", bench.log());
    }
}

#[test]
fn a_restarted_e_move_executes_nothing() {
    let mut bench = Bench::ready("HOME", 2);
    bench.hold("SHAFT", 200, 2);
    bench.process = crate::emove::Emove::default();
    assert_eq!(bench.finish(), error(Reason::Restarted));
    assert_eq!(bench.pause(), DONE);
    assert_eq!(bench.memory.v_grip.status.report, JawsReport::AtPosition);
    bench.world.object = Some(200);
    assert_eq!(bench.run(GraspObj, "SHAFT", 1, "", 2), DONE);
}
