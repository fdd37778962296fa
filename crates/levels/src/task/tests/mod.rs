mod bench;
mod confirmed;
mod coverage;
mod data_system;
mod recovery;

use interfaces::{
    Reason,
    emove::Holding,
    hws::{Checked, HwsReport},
    subtask::SubtaskVerb,
};
use rcs_core::name::Name16;

use self::bench::{Bench, DeliveryFault, FINISHED};
use super::plan::{Plan, TaskVerb};
use crate::subtask::tests::data::without;

pub(super) const SCENARIOS: &[fn()] = &[
    release_tool_of_an_empty_gripper_only_leaves,
    tool_command_without_names_uses_the_held_tool,
    unprepared_tool_command_is_refused,
    tool_command_with_unknown_contents_is_refused,
    acquire_tool_in_the_drum_needs_no_motion,
    command_with_a_bad_name_is_refused_before_any_motion,
    failure_of_subtask_is_passed_up_by_every_command,
    operator_takes_the_robot_during_a_command,
    operator_takes_the_robot_between_commands,
    command_that_fails_its_check_is_refused_and_the_next_one_is_executed,
];

const fn error(reason: Reason) -> (HwsReport, Reason) {
    (HwsReport::Error, reason)
}

const PAUSE: &str = "PAUSE -- 0 -- 0 0 -- 0 -- 0";
const STARTUP: &str = "STARTUP -- 0 -- 0 0 -- 0 -- 0";
const SHUTDOWN: &str = "SHUTDOWN -- 0 -- 0 0 -- 0 -- 0";
const HOME: &str = "MOVE -- 0 -- 0 0 HOME 0 -- 0";
const NOWHERE: &str = "MOVE -- 0 -- 0 0 NOWHERE 0 -- 0";
const SAFE: &str = "MOVE -- 0 -- 0 0 SAFE 0 -- 0";
const TRANSFER: &str = "TRANSFER PART +1 PFIXTURE 0 +1 UNIT_1 2 SAFE 0";
const TRANSFER_AND_STAY: &str = "TRANSFER PART +1 PFIXTURE 0 +1 UNIT_1 2 -- 0";
const FROM_TRAY: &str = "MOVE PART +1 UNIT_1 2 +1 PFIXTURE 0 -- 0";
const POSITION_RELEASE: &str = "POSITION PART +1 PFIXTURE 0 0 -- 0 -- 0";

#[test]
fn command_is_known_by_its_first_ten_characters() {
    for verb in TaskVerb::ALL.iter().filter(|verb| **verb != TaskVerb::None) {
        assert_eq!(TaskVerb::of(&Name16::new(verb.text()).unwrap()), Some(*verb));
        let ten: String = verb.text().chars().take(10).collect();
        assert_eq!(TaskVerb::of(&Name16::new(&ten).unwrap()), Some(*verb), "{ten}");
    }
    for word in ["", "DANCE", "TRANSFE", "TRANSFERS", "RELEASE", "INSERT-TO"] {
        assert_eq!(TaskVerb::of(&Name16::new(word).unwrap()), None, "{word}");
    }
}

#[test]
fn transfer_fetches_places_and_leaves() {
    let mut bench = Bench::default();
    assert_eq!(bench.run(TRANSFER), FINISHED);
    assert_eq!(bench.sent(), ["GET-ENDEFF", "GET-OBJECT", "PLACE-OBJ", "GOTO-ENDPT"]);
    let [_, get, place, leave] = bench.world.subtask.received[..] else { panic!() };
    assert_eq!((get.site.location.as_str(), place.site.location.as_str()), ("PFIXTURE", "UNIT_1"));
    assert_eq!(leave.site.location.as_str(), "SAFE");
    assert_eq!((place.site.array.number(), place.source_grip, place.destination_grip), (1, 1, 1));
    assert_eq!(bench.run(TRANSFER_AND_STAY), FINISHED);
    assert_eq!(bench.sent(), ["GET-ENDEFF", "GET-OBJECT", "PLACE-OBJ"]);
}

#[test]
fn object_is_regripped_when_the_grips_differ() {
    let mut bench = Bench::default();
    assert_eq!(bench.run("TRANSFER PART +1 PFIXTURE 0 -1 UNIT_1 2 SAFE 0"), FINISHED);
    assert_eq!(bench.sent(), ["GET-ENDEFF", "GET-OBJECT", "FIX-GRIP", "PLACE-OBJ", "GOTO-ENDPT"]);
    let [_, get, fix, place, _] = bench.world.subtask.received[..] else { panic!() };
    assert_eq!((fix.source_grip, fix.destination_grip), (1, -1));
    let grip = |grip| bench.data.object(&Name16::new("PART").unwrap(), grip).unwrap().0;
    assert_eq!((get.object_parameters, place.object_parameters), (grip(1), grip(-1)));
    assert_eq!(bench.run("MOVE PART +1 PFIXTURE 0 -1 SAFE 0 -- 0"), FINISHED);
    assert_eq!(bench.sent(), ["GET-ENDEFF", "GET-OBJECT", "FIX-GRIP", "MOVE-OBJ>D"]);
    assert_eq!(bench.run("TRANSFER BAR +1 PFIXTURE 0 +2 UNIT_1 2 SAFE 0"), error(Reason::NoPedestalData));
    assert!(bench.sent().is_empty(), "nothing moves");
}

#[test]
fn move_moves_an_object_or_the_robot() {
    let mut bench = Bench::default();
    assert_eq!(bench.run("MOVE PART +1 UNIT_1 1 +1 PFIXTURE 0 -- 0"), FINISHED);
    assert_eq!(bench.sent(), ["GET-ENDEFF", "GET-OBJECT", "MOVE-OBJ>D"]);
    assert_eq!(bench.run(SAFE), FINISHED);
    assert_eq!(bench.sent(), ["GOTO-DEST"]);
    assert!(bench.world.subtask.outputs.status.held.is_held(), "the held object is kept");
}

#[test]
fn position_releases_the_held_object_first() {
    let mut bench = Bench::default();
    for held in ["BAR", "PART"] {
        bench.set(1, held, "PFIXTURE");
        assert_eq!(bench.run(POSITION_RELEASE), FINISHED);
        assert_eq!(bench.sent(), ["RELEASE", ">POSITION"]);
    }
    assert_eq!(bench.run("POSITION -- 0 -- 0 0 SAFE 0 -- 0"), FINISHED);
    assert_eq!(bench.sent(), [">POSITION"]);
    assert_eq!(bench.world.subtask.outputs.status.at.unwrap().site.location.as_str(), "SAFE");
}

#[test]
fn acquire_gets_the_gripper_and_the_object() {
    let mut bench = Bench::default();
    assert_eq!(bench.run("ACQUIRE CYLINDER +1 PFIXTURE 0 0 -- 0 -- 0"), FINISHED);
    assert_eq!(bench.sent(), ["GET-ENDEFF", "GET-OBJECT"]);
    assert_eq!(bench.world.subtask.received[0].end_effector_id, Some(2));
}

#[test]
fn refixture_skips_completed_steps() {
    let line = "REFIXTURE PART +1 PFIXTURE 0 -1 PFIXTURE 0 -- 0";
    let mut bench = Bench::default();
    assert_eq!(bench.run(line), FINISHED);
    assert_eq!(bench.sent(), ["GET-ENDEFF", "GET-OBJECT", "FIX-GRIP", "MOVE-OBJ>D"]);
    let mut bench = Bench::default();
    assert_eq!(bench.run("ACQUIRE PART +1 PFIXTURE 0 0 -- 0 -- 0"), FINISHED);
    assert_eq!(bench.run(line), FINISHED);
    assert_eq!(bench.sent(), ["GET-OBJECT", "FIX-GRIP", "MOVE-OBJ>D"]);
    assert_eq!(bench.run("REFIXTURE BAR +1 PFIXTURE 0 +2 SAFE 0 -- 0"), error(Reason::NoPedestalData));
}

const INSERT: &str = "INSERT-TOOL TOOL-1 +1 TOOL-SAFE 0 0 -- 0 -- 0";
const RELEASE: &str = "RELEASE-TOOL TOOL-1 +1 -- 0 0 -- 0 TOOL-SAFE 0";
const ACQUIRE: &str = "ACQUIRE-TOOL TOOL-1 0 -- 0 +1 TOOL-SAFE 0 -- 0";
const REMOVE: &str = "REMOVE-TOOL TOOL-1 +1 -- 0 0 -- 0 TOOL-SAFE 0";

#[test]
fn insert_and_release_tool_are_done_once() {
    let mut bench = Bench::default();
    bench.set(3, "TOOL-1", "TOOL-SAFE");
    assert_eq!(bench.run(INSERT), FINISHED);
    assert_eq!(bench.sent(), ["INSERT-TOOL"]);
    let command = bench.world.subtask.received[0];
    let (parameters, _) = bench.data.object(&Name16::new("TOOL-1").unwrap(), 1).unwrap();
    assert_eq!(
        (command.end_effector_id, command.object_parameters, command.source_grip),
        (Some(3), parameters, 1)
    );
    assert_eq!((bench.run(INSERT), bench.sent()), (FINISHED, vec![]), "it is there already");
    assert_eq!(bench.run(RELEASE), FINISHED);
    assert_eq!(bench.sent(), ["RELEASE-TOOL", "GOTO-ENDPT"]);
    assert_eq!((bench.run(RELEASE), bench.sent()), (FINISHED, vec![]), "it is released already");
}

#[test]
fn acquire_and_remove_tool_are_done_once() {
    let mut bench = Bench::default();
    assert_eq!(bench.run(ACQUIRE), FINISHED);
    assert_eq!(bench.sent(), ["GET-ENDEFF", "GOTO-DEST", "ACQUIRE-TOOL"]);
    let [gripper, near, acquire] = bench.world.subtask.received[..] else { panic!() };
    assert_eq!((gripper.end_effector_id, near.site.location.as_str()), (Some(3), "TOOL-SAFE"));
    assert_eq!((acquire.object.unwrap_or_default().as_str(), acquire.source_grip), ("TOOL-1", 1));
    assert_eq!((bench.run(ACQUIRE), bench.sent()), (FINISHED, vec![]), "it is held already");
    assert_eq!(bench.run(REMOVE), FINISHED);
    assert_eq!(bench.sent(), ["REMOVE-TOOL", "GOTO-ENDPT"]);
    assert_eq!((bench.run(REMOVE), bench.sent()), (FINISHED, vec![]), "it is removed already");
}

#[test]
fn release_tool_of_an_empty_gripper_only_leaves() {
    for (line, sent) in [(RELEASE, &["GOTO-ENDPT"][..]), ("RELEASE-TOOL TOOL-1 +1 -- 0 0 -- 0 -- 0", &[])] {
        let mut bench = Bench::default();
        bench.set(3, "", "TOOL-TRNS");
        bench.world.subtask.outputs.status.drum = false;
        bench.step();
        assert_eq!(bench.run(line), FINISHED, "{line}");
        assert_eq!(bench.sent(), sent, "{line}");
    }
}

#[test]
fn tool_command_without_names_uses_the_held_tool() {
    let mut bench = Bench::default();
    bench.set(3, "TOOL-1", "TOOL-TRNS");
    for (line, word) in [
        ("REMOVE-TOOL -- 0 -- 0 0 -- 0 -- 0", "REMOVE-TOOL"),
        ("RELEASE-TOOL -- 0 -- 0 0 -- 0 -- 0", "RELEASE-TOOL"),
    ] {
        assert_eq!(bench.run(line), FINISHED);
        assert_eq!(bench.sent(), [word]);
        assert_eq!(bench.world.subtask.received[0].object.unwrap_or_default().as_str(), "TOOL-1");
        assert_eq!(bench.world.subtask.received[0].end_effector_id, Some(3));
    }
    // Only TOOL-SAFE is near the drum; the source in the command has no effect.
    bench.set(3, "TOOL-1", "HOME");
    assert_eq!(bench.run("INSERT-TOOL TOOL-1 +1 HOME 0 0 -- 0 -- 0"), error(Reason::NotPrepared));
}

#[test]
fn unprepared_tool_command_is_refused() {
    for (line, gripper, object, at, reason) in [
        (INSERT, 3, "TOOL-1", "HOME", Reason::NotPrepared),
        (INSERT, 3, "", "TOOL-SAFE", Reason::NotPrepared),
        (INSERT, 3, "PART", "TOOL-SAFE", Reason::NotPrepared),
        (INSERT, 1, "TOOL-1", "TOOL-SAFE", Reason::NotPrepared),
        (INSERT, 0, "", "TOOL-SAFE", Reason::NotPrepared),
        (RELEASE, 3, "TOOL-1", "TOOL-SAFE", Reason::NotPrepared),
        (RELEASE, 3, "TOOL-1", "HOME", Reason::NotPrepared),
        (RELEASE, 3, "", "HOME", Reason::NotPrepared),
        (RELEASE, 1, "", "TOOL-SAFE", Reason::NotPrepared),
        (REMOVE, 3, "TOOL-1", "HOME", Reason::NotPrepared),
        (REMOVE, 3, "", "TOOL-TRNS", Reason::NotPrepared),
        (REMOVE, 1, "", "TOOL-TRNS", Reason::NotPrepared),
        (ACQUIRE, 3, "TOOL-1", "TOOL-SAFE", Reason::AlreadyHolding),
        (ACQUIRE, 1, "PART", "HOME", Reason::AlreadyHolding),
    ] {
        let mut bench = Bench::default();
        bench.set(gripper, object, at);
        assert_eq!(bench.run(line), error(reason), "{line}, gripper {gripper}, {object} at {at}");
        assert!(bench.sent().is_empty());
    }
}

#[test]
fn tool_command_with_unknown_contents_is_refused() {
    for (held, acquired) in
        [(Holding::Something, Reason::UnknownHeld), (Holding::NotKnown, Reason::HeldNotKnown)]
    {
        let with = |line: &str| {
            let mut bench = Bench::default();
            bench.set(3, "", "HOME");
            bench.world.subtask.outputs.status.held = held;
            bench.step();
            (bench.run(line), bench.sent())
        };
        for (line, reason) in [
            (INSERT, Reason::UnknownHeld),
            (RELEASE, Reason::UnknownHeld),
            (REMOVE, Reason::UnknownHeld),
            (ACQUIRE, acquired),
        ] {
            assert_eq!(with(line), (error(reason), vec![]), "{line}, {held:?}");
        }
        // Subtask reports an object that obstructs the fetch.
        let (end, sent) = with("REFIXTURE PART +1 PFIXTURE 0 -1 PFIXTURE 0 -- 0");
        assert_eq!((end, sent[0]), (FINISHED, "GET-ENDEFF"));
    }
}

#[test]
fn acquire_tool_in_the_drum_needs_no_motion() {
    let mut bench = Bench::default();
    bench.set(3, "", "TOOL-TRNS");
    assert_eq!((bench.run(ACQUIRE), bench.sent()), (FINISHED, vec!["ACQUIRE-TOOL"]));
}

/// Incomplete commands, and the reasons for refusing them.
const REFUSED: &[(&str, Reason)] = &[
    ("DANCE -- 0 -- 0 0 -- 0 -- 0", Reason::UnknownCommand),
    ("MOVE NOBODY +1 UNIT_1 1 +1 SAFE 0 -- 0", Reason::UnknownObject),
    (NOWHERE, Reason::UnknownLocation),
    ("MOVE -- 0 -- 0 0 HOLSTER 1 -- 0", Reason::NoObjectNamed),
    ("MOVE -- 0 -- 0 0 -- 0 -- 0", Reason::NoDestination),
    ("MOVE PART +1 -- 0 +1 SAFE 0 -- 0", Reason::NoDestination),
    ("MOVE PART +1 UNIT_1 9 +1 SAFE 0 -- 0", Reason::SectorOutOfRange),
    ("MOVE PART +7 UNIT_1 1 +7 SAFE 0 -- 0", Reason::UnknownGrip),
    ("TRANSFER -- 0 UNIT_1 0 0 SAFE 0 -- 0", Reason::NoObjectNamed),
    ("TRANSFER PART +1 PFIXTURE 0 +7 UNIT_1 2 SAFE 0", Reason::UnknownGrip),
    ("TRANSFER BAR +1 PFIXTURE 0 +2 UNIT_1 2 SAFE 0", Reason::NoPedestalData),
    ("TRANSFER PART +1 PFIXTURE 0 +1 PEDESTAL 0 SAFE 0", Reason::PedestalOnly),
    ("POSITION -- 0 -- 0 0 -- 0 -- 0", Reason::NoDestination),
    ("POSITION PART 0 -- 0 +7 SAFE 0 -- 0", Reason::UnknownGrip),
    ("POSITION PART +7 PFIXTURE 0 +1 SAFE 0 -- 0", Reason::UnknownGrip),
    ("REFIXTURE PART +1 PFIXTURE 0 -1 -- 0 -- 0", Reason::NoDestination),
    ("ACQUIRE -- 0 PFIXTURE 0 0 -- 0 -- 0", Reason::NoObjectNamed),
    ("ACQUIRE PART +1 -- 0 0 -- 0 -- 0", Reason::NoDestination),
    ("ACQUIRE-TOOL -- 0 -- 0 0 TOOL-SAFE 0 -- 0", Reason::NoObjectNamed),
    ("ACQUIRE-TOOL TOOL-1 0 -- 0 +1 -- 0 -- 0", Reason::NoDestination),
    ("ACQUIRE-TOOL TOOL-1 0 -- 0 +4 TOOL-SAFE 0 -- 0", Reason::UnknownGrip),
    ("ACQUIRE-TOOL PART 0 -- 0 +1 TOOL-SAFE 0 -- 0", Reason::WrongGripper),
    ("ACQUIRE-TOOL TOOL-1 0 -- 0 +1 HOME 0 -- 0", Reason::NotNearDrum),
    ("REFIXTURE PART +1 PFIXTURE 0 +1 SAFE 0 -- 0", Reason::EqualGrips),
    ("INSERT-TOOL PART +1 TOOL-SAFE 0 0 -- 0 -- 0", Reason::WrongGripper),
    ("RELEASE-TOOL TOOL-1 +1 -- 0 0 -- 0 HOME 0", Reason::NoTrajectory),
    ("REMOVE-TOOL TOOL-1 +1 -- 0 0 -- 0 HOME 0", Reason::NoTrajectory),
    ("REMOVE-TOOL TOOL-1 +1 -- 0 0 -- 0 UNIT_1 2", Reason::NoTrajectory),
];

#[test]
fn command_with_a_bad_name_is_refused_before_any_motion() {
    for (line, reason) in REFUSED {
        let mut bench = Bench::default();
        assert_eq!(bench.run(line), error(*reason), "{line}");
        assert!(bench.sent().is_empty());
    }
    let store = without(&["-o-loc- PART"]);
    let mut bench = Bench::of(store.view());
    assert_eq!(bench.run("MOVE PART +1 UNIT_1 1 +1 SAFE 0 -- 0"), error(Reason::NoArrayForObject));
}

#[test]
fn refused_command_keeps_the_published_poses() {
    let mut bench = Bench::default();
    assert_eq!(bench.run(SAFE), FINISHED);
    let poses = bench.memory.task.poses;
    for (line, _) in REFUSED {
        bench.run(line);
        assert_eq!(bench.memory.task.poses, poses, "{line}");
    }
}

#[test]
fn failure_of_subtask_is_passed_up_by_every_command() {
    for (line, verb, gripper, object, at) in [
        (PAUSE, SubtaskVerb::Pause, 1, "", ""),
        ("TRANSFER PART +1 PFIXTURE 0 -1 UNIT_1 2 SAFE 0", SubtaskVerb::FixGrip, 1, "", ""),
        ("MOVE PART +1 PFIXTURE 0 -1 SAFE 0 -- 0", SubtaskVerb::MoveObjToDest, 1, "", ""),
        ("POSITION -- 0 -- 0 0 SAFE 0 -- 0", SubtaskVerb::Position, 1, "", ""),
        ("ACQUIRE PART +1 PFIXTURE 0 0 -- 0 -- 0", SubtaskVerb::GetObject, 1, "", ""),
        ("REFIXTURE PART +1 PFIXTURE 0 -1 SAFE 0 -- 0", SubtaskVerb::GetEndeff, 1, "", ""),
        (INSERT, SubtaskVerb::InsertTool, 3, "TOOL-1", "TOOL-SAFE"),
        (RELEASE, SubtaskVerb::GotoEndpt, 3, "TOOL-1", "TOOL-TRNS"),
        (ACQUIRE, SubtaskVerb::AcquireTool, 3, "", "HOME"),
        (REMOVE, SubtaskVerb::RemoveTool, 3, "TOOL-1", "TOOL-TRNS"),
    ] {
        for (mishap, reason) in [
            (DeliveryFault::Error(Reason::NotAtGoal), Reason::NotAtGoal),
            (DeliveryFault::Silence, Reason::NeighbourLost),
        ] {
            let mut bench = Bench::default();
            bench.set(gripper, object, at);
            bench.world.subtask.mishap = Some((verb, mishap));
            assert_eq!(bench.run(line), error(reason), "{line}");
            let sent = bench.world.subtask.received.len();
            (0..20).for_each(|_| assert_eq!(bench.step().status.report, HwsReport::Error));
            assert_eq!(bench.world.subtask.received.len(), sent, "no order after an error");
        }
    }
}

#[test]
fn operator_takes_the_robot_during_a_command() {
    let mut bench = Bench::default();
    bench.command(SAFE);
    (0..3).for_each(|_| assert_eq!(bench.step().status.report, HwsReport::Executing));
    bench.world.subtask.joystick = true;
    bench.step();
    bench.step();
    for _ in 0..30 {
        let status = bench.step().status;
        assert_eq!((status.report, status.reason), (HwsReport::JoystickOn, Reason::JoystickOn));
    }
    assert_eq!(bench.sent(), ["GOTO-DEST", "S-PAUSE"], "one pause is enough");
    // No command is executed while the operator controls the robot.
    assert_eq!(bench.run(HOME), (HwsReport::JoystickOn, Reason::JoystickOn));
    assert!(bench.sent().is_empty());
    bench.world.subtask.joystick = false;
    bench.wait(5);
    for _ in 0..30 {
        let status = bench.step().status;
        assert_eq!((status.report, status.reason), (HwsReport::Error, Reason::JoystickOn));
    }
    assert!(bench.sent().is_empty(), "the interrupted command is not resumed");
    assert_eq!(bench.run(HOME), FINISHED);
}

#[test]
fn operator_takes_the_robot_between_commands() {
    let mut bench = Bench::default();
    assert_eq!(bench.run(SAFE), FINISHED);
    bench.world.subtask.joystick = true;
    bench.wait(30);
    assert_eq!(bench.sent(), ["GOTO-DEST", "S-PAUSE"]);
    assert_eq!(bench.memory.task.status.report, HwsReport::JoystickOn);
    bench.world.subtask.joystick = false;
    bench.wait(5);
    assert_eq!((bench.step().status.report, bench.step().status.reason), (HwsReport::Idle, Reason::None));
    // The box also becomes active before any command.
    let mut bench = Bench::default();
    bench.world.subtask.joystick = true;
    bench.wait(30);
    assert_eq!((bench.sent(), bench.memory.task.status.report), (vec!["S-PAUSE"], HwsReport::JoystickOn));
}

#[test]
fn command_in_the_tick_of_manual_control_is_not_executed() {
    for (line, reason) in
        [(HOME, Reason::JoystickOn), (NOWHERE, Reason::UnknownLocation), (PAUSE, Reason::JoystickOn)]
    {
        let mut bench = Bench::default();
        bench.world.subtask.joystick = true;
        bench.step();
        bench.command(line);
        bench.wait(30);
        assert_eq!(bench.sent(), ["S-PAUSE"], "{line}");
        assert_eq!(bench.memory.task.status.report, HwsReport::JoystickOn);
        bench.world.subtask.joystick = false;
        bench.wait(5);
        let status = bench.step().status;
        assert_eq!((status.report, status.reason), error(reason), "{line}");
    }
}

#[test]
fn command_that_fails_its_check_is_refused_and_the_next_one_is_executed() {
    let mut bench = Bench::default();
    bench.command(TRANSFER);
    bench.external.hws.checked = Checked::Fails;
    assert_eq!(bench.finish(), error(Reason::CheckFailed));
    assert!(bench.sent().is_empty(), "nothing moves");
    assert_eq!(bench.run(SAFE), FINISHED);
    bench.command(PAUSE);
    bench.external.hws.checked = Checked::Fails;
    assert_eq!(bench.finish(), FINISHED, "PAUSE is always accepted");
}

#[test]
fn pause_during_manual_control_is_accepted() {
    let mut bench = Bench::default();
    bench.world.subtask.joystick = true;
    bench.wait(10);
    bench.command(PAUSE);
    (0..30).for_each(|_| assert_eq!(bench.step().status.report, HwsReport::JoystickOn));
    assert_eq!(bench.sent(), ["S-PAUSE", "S-PAUSE"]);
    bench.world.subtask.joystick = false;
    bench.wait(5);
    assert_eq!(bench.step().status.reason, Reason::JoystickOn);
    assert_eq!(bench.run(PAUSE), FINISHED);
}

#[test]
fn each_location_of_a_command_has_its_own_pose() {
    let mut bench = Bench::default();
    assert_eq!(bench.run(TRANSFER), FINISHED);
    let plan = Plan::look_up(&bench.external.hws, &bench.data).plan;
    for (command, site) in
        bench.world.subtask.received[1..].iter().zip([plan.source, plan.destination, plan.end_at])
    {
        let pose = site.location.map(|location| location.pose.pose);
        assert_eq!(
            command.pose.and_then(|pose| bench.memory.changing_pose(pose)).copied(),
            pose,
            "{}",
            command.command
        );
    }
}
