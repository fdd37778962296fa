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
    bench::{Bench, DONE, PAUSE, error, frame_of, given, moved},
    doubles::DeliveryFault,
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
    failed_pause_reports_its_reason,
    returned_robot_is_done_when_all_processes_rest,
    command_during_manual_control_is_refused,
    link_failure_during_pause_is_initialized_again_or_reported,
];

#[test]
fn link_failure_during_pause_is_initialized_again_or_reported() {
    // The gripper is not calibrated yet.
    let mut bench = Bench::new("HOME", 1);
    bench.spoil("PAUSE", DeliveryFault::Never);
    bench.command(Pause, "", 0, "", 0);
    bench.wait(40);
    (bench.world.prim.report, bench.world.prim.reason) = (PrimReport::T3LinkErr, Reason::LinkError);
    let before = bench.log().len();
    bench.wait(40);
    assert_eq!(bench.log()[before..before + 2], ["ROBOT-INIT", "PAUSE"]);
    assert_eq!(bench.memory.emove.status.report, StatusReport::Executing);
    let mut again = bench.clone();
    (again.world.prim.report, again.world.prim.reason) = (PrimReport::T3LinkErr, Reason::LinkError);
    assert_eq!(again.finish(), error(Reason::LinkError), "no third initialization");
    bench.world.dead.push("Prim");
    assert_eq!(bench.finish(), error(Reason::NeighbourLost));
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.pause(), DONE);
    (bench.world.prim.report, bench.world.prim.reason) = (PrimReport::T3LinkErr, Reason::LinkError);
    bench.wait(3);
    let status = &bench.memory.emove.status;
    assert_eq!(
        (status.report, status.reason),
        (StatusReport::Done, Reason::LinkError),
        "E-PAUSE has not failed"
    );
    assert_eq!(bench.pause(), DONE);
}

#[test]
fn operator_initializes_the_link_during_a_pause() {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.pause(), DONE);
    bench.world.log.clear();
    bench.external.operator.robot_init = 7;
    bench.wait(40);
    assert_eq!(bench.log(), ["ROBOT-INIT", "PAUSE", "QC-PAUSE"]);
    assert_eq!(bench.memory.emove.status.report, StatusReport::Done, "the report stays done");
    // A restarted E-move does not initialize it again.
    bench.restart_and_finish();
    assert_eq!(bench.pause(), DONE);
    bench.world.log.clear();
    bench.wait(40);
    assert!(bench.log().is_empty(), "{:?}", bench.log());
}

#[test]
fn first_pause_starts_the_link() {
    let mut bench = Bench::new("HOME", 1);
    assert_eq!(bench.pause(), DONE);
    assert_eq!(bench.log(), ["ROBOT-INIT", "PAUSE", "QC-PAUSE", "PAUSE"], "Prim, Quick Change, Grip");
    assert_eq!(bench.pause(), DONE);
    assert!(!bench.log().contains(&"ROBOT-INIT"), "the link is up");
}

#[test]
fn pause_accepts_each_gripper_at_the_start() {
    for gripper in 0..=3 {
        let mut bench = Bench::new("HOME", gripper);
        // The pause does not depend on the opening of the fingers.
        (bench.world.v_grip.opening, bench.world.tool_grip.opening) = (200, 200);
        assert_eq!(bench.pause(), DONE);
        assert_eq!(bench.memory.emove.status.end_effector_id, given(gripper));
    }
}

#[test]
fn pause_waits_for_the_calibration() {
    let mut bench = Bench::new("HOME", 1);
    bench.spoil("PAUSE", DeliveryFault::Never);
    bench.command(Pause, "", 0, "", 0);
    bench.wait(200);
    assert_eq!(bench.memory.prim.status.report, PrimReport::Done);
    assert_eq!(bench.memory.emove.status.report, StatusReport::Executing, "Grip's PAUSE is not done before");
}

#[test]
fn only_the_attached_gripper_is_awake() {
    let all = Dormancy { grip: true, v_grip: true, tool_grip: true };
    for (gripper, dormant) in [
        (0, all),
        (1, Dormancy { grip: false, ..all }),
        (2, Dormancy { v_grip: false, ..all }),
        (3, Dormancy { tool_grip: false, ..all }),
    ] {
        let mut bench = Bench::new("HOME", 0);
        bench.world.mated = gripper;
        bench.wait(2);
        assert_eq!(bench.memory.emove.dormant, dormant, "gripper {gripper}, without any command");
    }
}

#[test]
fn failed_pause_reports_its_reason() {
    let mut bench = Bench::new("HOME", 1);
    bench.spoil("QC-PAUSE", DeliveryFault::Ring(QuickChangeReport::SensorMalfunction));
    assert_eq!(bench.pause(), error(Reason::QuickChangeFault));
    let mut bench = Bench::new("HOME", 1);
    bench.command(Pause, "", 0, "", 0);
    bench.wait(10);
    bench.world.dead.push("Quick Change");
    assert_eq!(bench.finish(), error(Reason::NeighbourLost));
    let mut bench = Bench::new("HOME", 2);
    bench.command(Pause, "", 0, "", 0);
    bench.wait(10);
    bench.world.dead.push("gripper");
    assert_eq!(bench.finish(), error(Reason::NeighbourLost));
    let mut bench = Bench::ready("HOME", 1);
    bench.command(Pause, "", 0, "", 0);
    bench.wait(3);
    bench.world.dead.push("Prim");
    assert_eq!(bench.finish(), error(Reason::NeighbourLost));
    let mut bench = Bench::new("HOME", 1);
    bench.spoil("ROBOT-INIT", DeliveryFault::Prim(PrimReport::T3LinkOff, Reason::LinkOff));
    assert_eq!(bench.pause(), error(Reason::LinkOff));
    let mut bench = Bench::new("HOME", 1);
    bench.spoil("ROBOT-INIT", DeliveryFault::Joystick);
    assert_eq!(bench.pause().1, Reason::JoystickOn);
    let mut bench = Bench::new("HOME", 1);
    bench.command(Pause, "", 0, "", 0);
    bench.wait(3);
    bench.world.mated = 2;
    assert_eq!(bench.finish(), DONE, "E-PAUSE does not wait for a gripper attached since");
}

#[test]
fn ring_between_its_ends_is_at_rest() {
    let mut bench = Bench::new("HOME", 1);
    bench.spoil("QC-PAUSE", DeliveryFault::Ring(QuickChangeReport::Stuck));
    assert_eq!(bench.pause(), DONE);
    assert_eq!(bench.memory.quick_change.status.ring, RingPosition::Between);
    assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), error(Reason::RingNotLocked));
}

#[test]
fn fingers_finish_their_order_before_pause() {
    for (gripper, object, size) in [(1, "BLOCK", 75), (2, "SHAFT", 200), (3, "CUTTER", 250)] {
        let mut bench = Bench::ready("HOME", gripper);
        bench.world.object = Some(size);
        for mut fork in bench.during((GraspObj, object, 1, "", gripper)) {
            assert_eq!(fork.execute(PAUSE), DONE);
            let log = fork.log();
            let closed = log.iter().position(|text| text.contains("CLOSE") || text.contains("GRASP"));
            let paused = log.iter().rposition(|text| text.contains("PAUSE")).unwrap_or_default();
            assert!(closed.is_none_or(|closed| closed < paused), "{log:?}");
            let held = fork.memory.emove.status.held;
            let named = held.object().is_some_and(|held| held.as_str() == object);
            assert!(closed.is_none() || named, "the grasped object has the name in the command: {held:?}");
        }
        assert_eq!(bench.run(GraspObj, object, 1, "", gripper), DONE);
        assert!(bench.memory.emove.status.held.is_held());
    }
}

#[test]
fn pause_finds_the_location_of_the_robot() {
    let mut bench = Bench::new("HOLSTER-C", 0);
    assert_eq!(bench.pause(), DONE);
    assert!(bench.memory.emove.status.at.is_none(), "a holster is not a plain location");
    bench.world.frame = frame_of("BENCH");
    assert_eq!(bench.pause(), DONE);
    assert_eq!(bench.at(), "BENCH");
    bench.world.frame = moved(frame_of("HOME"), &["300ty"]);
    assert_eq!(bench.pause(), DONE, "the robot may be at an unknown place");
    assert!(bench.memory.emove.status.at.is_none());
}

#[test]
fn location_search_runs_only_during_pause() {
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

/// A pause that is done continues; another command that has ended does not.
#[test]
fn only_a_finished_pause_continues() {
    for &pause in tables::Pause::ALL {
        for &outcome in Outcome::ALL {
            let watch = Watch {
                initialization: tables::Initialization::None,
                pause,
                outcome,
                place: PlaceKnowledge::Known,
                resolvers: Knowledge::Known,
            };
            let has_next =
                pause == tables::Pause::Standing && matches!(outcome, Outcome::Done | Outcome::Joystick);
            assert_eq!(attend((), &watch) == Verdict::Passed(()), has_next, "{pause} {outcome}");
            // `.R` initializes the link, then the pause continues.
            for (initialization, action) in [
                (tables::Initialization::Asked, Action::RobotInit),
                (tables::Initialization::Over, Action::StopRobot),
            ] {
                let expected = if has_next { action } else { Action::Wait };
                let Verdict::Decided(found) = attend((), &Watch { initialization, ..watch }) else {
                    panic!("{pause} {outcome}: the tables of the commands must not decide");
                };
                assert_eq!(found.action, expected, "{pause} {outcome}");
            }
        }
    }
}

#[test]
fn operator_moves_robot_and_fingers() {
    for gripper in 1..=3 {
        let mut bench = Bench::ready("HOME", gripper);
        let (object, size) = [("BLOCK", 75), ("SHAFT", 200), ("CUTTER", 250)][usize::from(gripper) - 1];
        bench.hold(object, size, gripper);
        assert_eq!(bench.pause(), DONE);
        bench.world.joystick = true;
        bench.wait(3);
        let status = bench.memory.emove.status;
        assert_eq!((status.report, status.reason), (StatusReport::JoystickOn, Reason::JoystickOn));
        bench.world.log.clear();
        bench.world.button = JoystickGrip::Open;
        bench.wait(20);
        assert_eq!(bench.log().len(), 1, "only a new press acts: {:?}", bench.log());
        assert!(!bench.memory.emove.status.held.is_held(), "the fingers are open");
        assert!(bench.memory.emove.status.placed.is_some());
        bench.world.button = JoystickGrip::None;
        bench.wait(3);
        bench.world.button = JoystickGrip::Close;
        bench.wait(20);
        assert_eq!(bench.log().len(), 2);
        assert_eq!(bench.memory.emove.status.placed, None, "the part may be between the fingers again");
        let closed = [bench.world.grip.opening, bench.world.v_grip.opening, bench.world.tool_grip.opening];
        assert_eq!(closed[usize::from(gripper) - 1], [10, 50, 100][usize::from(gripper) - 1]);
        // The operator has moved the robot to the vise and gives it back.
        bench.world.frame = frame_of("VISE");
        (bench.world.joystick, bench.world.button) = (false, JoystickGrip::None);
        bench.wait(10);
        let status = bench.memory.emove.status;
        assert_eq!(
            (status.report, status.reason, status.at.unwrap_or_default().site.location.as_str()),
            (StatusReport::Done, Reason::None, "VISE")
        );
    }
    // Without frame switches the buttons also work. If the switch is turned during a pause, the operator controls the
    // robot.
    let mut bench = Bench::ready("HOME", 1);
    bench.world.joystick = true;
    assert_eq!(bench.pause(), (StatusReport::JoystickOn, Reason::JoystickOn));
    bench.world.joystick = false;
    bench.wait(10);
    assert_eq!(bench.memory.emove.status.report, StatusReport::Done);
    bench.world.dead.push("Prim");
    bench.wait(5);
    assert_eq!(bench.memory.emove.status.report, StatusReport::Done, "the report stays done");
}

/// The operator returns the control while the fingers move, while the ring pauses, or with a failing link, and takes
/// it again before all processes are at rest.
#[test]
fn returned_robot_is_done_when_all_processes_rest() {
    let led = || {
        let mut bench = Bench::ready("HOME", 2);
        assert_eq!(bench.pause(), DONE);
        bench.world.joystick = true;
        bench.wait(3);
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
    bench.wait(2);
    assert!(ticks(&mut bench) > at_rest, "the fingers open first");
    let mut bench = led();
    bench.spoil("QC-PAUSE", DeliveryFault::Ring(QuickChangeReport::Executing));
    bench.world.joystick = false;
    bench.wait(20);
    assert_eq!(bench.memory.emove.status.report, StatusReport::JoystickOn, "Quick Change never pauses");
    for again in 1..at_rest {
        let mut bench = led();
        bench.world.joystick = false;
        bench.wait(again);
        bench.world.joystick = true;
        bench.wait(4);
        assert_eq!(bench.memory.emove.status.report, StatusReport::JoystickOn, "after {again} ticks");
        ticks(&mut bench);
    }
    let mut bench = led();
    bench.spoil("PAUSE", DeliveryFault::Prim(PrimReport::T3LinkErr, Reason::LinkError));
    ticks(&mut bench);
    assert_eq!(bench.memory.emove.status.reason, Reason::LinkError, "done with a reason");
    let mut bench = led();
    bench.memory.prim.status.report = PrimReport::T3LinkErr;
    bench.world.dead.push("Prim");
    bench.wait(2);
    assert_eq!(bench.memory.emove.status.report, StatusReport::Done, "done with a reason");
}

#[test]
fn operator_interrupts_a_command() {
    let mut bench = Bench::ready("HOME", 1);
    bench.command(MovToLoc, "", 0, "VISE", 0);
    bench.wait(7);
    bench.world.joystick = true;
    assert_eq!(bench.finish(), (StatusReport::JoystickOn, Reason::JoystickOn));
    assert_eq!(bench.pause(), (StatusReport::JoystickOn, Reason::JoystickOn));
    bench.world.joystick = false;
    bench.wait(10);
    assert_eq!(bench.memory.emove.status.report, StatusReport::Done);
    // An interrupted command without a pause ends in an error when the box is released.
    let mut bench = Bench::ready("HOME", 1);
    bench.spoil("GO-THRU", DeliveryFault::Joystick);
    assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), (StatusReport::JoystickOn, Reason::JoystickOn));
    bench.memory.prim.status.report = PrimReport::Done;
    bench.world.dead.push("Prim");
    bench.wait(2);
    let status = bench.memory.emove.status;
    assert_eq!((status.report, status.reason), error(Reason::JoystickOn));
}

/// A command arrives in the tick in which the operator takes control of the robot: fingers and ring stay as they are.
#[test]
fn command_during_manual_control_is_refused() {
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
        bench.wait(5);
        let status = bench.memory.emove.status;
        assert_eq!((status.report, status.reason), error(Reason::JoystickOn), "{verb}");
        assert_eq!(status.held.is_held(), holds, "{verb}");
        assert!(bench.log().is_empty(), "{verb}: {:?}", bench.log());
    }
}

#[test]
fn restarted_emove_executes_nothing() {
    let mut bench = Bench::ready("HOME", 2);
    bench.hold("SHAFT", 200, 2);
    bench.restart_and_finish();
    assert_eq!(bench.pause(), DONE);
    assert_eq!(bench.memory.v_grip.status.report, JawsReport::AtPosition);
    bench.world.object = Some(200);
    assert_eq!(bench.run(GraspObj, "SHAFT", 1, "", 2), DONE);
}
