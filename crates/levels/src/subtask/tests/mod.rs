mod bench;
mod confirmed;
pub(crate) mod data;
mod recovery;

use interfaces::{
    Reason, StatusReport, SubtaskOutputs,
    emove::{EmoveVerb, Holding},
    grip::Felt,
    location::LocationKind,
    pedestal::{PedestalReport, PedestalVerb},
    pose_range,
    subtask::SubtaskVerb,
};
use rcs_core::name::Name16;
use taskdata::files::TaskData;

use self::{
    bench::{Bench, DONE, DeliveryFault},
    data::without,
};
use super::Subtask;
use crate::coverage::silent;

fn error(reason: Reason) -> (StatusReport, Reason) {
    (StatusReport::Error, reason)
}

fn pose_of(bench: &Bench<'_>, number: u32) -> Option<geometry::pose::Pose> {
    bench.memory.changing_pose(number).copied()
}

#[test]
fn link_failure_after_a_pause_changes_only_the_reason() {
    let mut bench = Bench::default();
    assert_eq!(bench.run(SubtaskVerb::Pause, "", (0, 0), ""), DONE);
    bench.world.emove.outputs.status.reason = Reason::LinkOff;
    bench.step();
    bench.step();
    let status = bench.memory.subtask.status;
    assert_eq!((status.report, status.reason), (StatusReport::Done, Reason::LinkOff));
    assert_eq!(bench.run(SubtaskVerb::GotoDest, "", (0, 0), "HOME"), DONE);
}

#[test]
fn right_gripper_is_not_fetched() {
    let mut bench = Bench::default();
    assert_eq!(bench.run(SubtaskVerb::GetEndeff, "PART", (1, 1), "PFIXTURE"), DONE);
    assert!(bench.sent().is_empty());
    // Any gripper will do for an object that names none.
    assert_eq!(bench.run(SubtaskVerb::GetEndeff, "GRIPPER-1", (1, 1), ""), DONE);
    assert!(bench.sent().is_empty());
}

#[test]
fn wrong_gripper_is_exchanged_for_the_right_one() {
    let mut bench = Bench::default();
    assert_eq!(bench.run(SubtaskVerb::GetEndeff, "CYLINDER", (1, 1), "PFIXTURE"), DONE);
    assert_eq!(bench.sent(), ["MOV-TO-HOL", "QC-DETACH", "MOV-TO-HOL", "QC-ATTACH"]);
    let aims: Vec<_> = bench
        .world
        .emove
        .received
        .iter()
        .map(|c| {
            (
                c.object.as_ref().map_or("", Name16::as_str),
                c.grip,
                c.site.location.as_str(),
                c.end_effector_id,
            )
        })
        .collect();
    let (own, wanted) = (("GRIPPER-1", 1, "HOLSTER-R", Some(1)), ("GRIPPER-2", 2, "HOLSTER-L", Some(2)));
    assert_eq!(aims, [own, own, wanted, wanted]);
    for command in &bench.world.emove.received {
        assert_eq!(command.pose.unwrap() & pose_range::WRITER, pose_range::SUBTASK);
        let locpt = bench.data.locpt(bench.data.locpt_named(&command.site.location).unwrap()).unwrap();
        let expected = geometry::pose::Pose::from_frame(&locpt.frame);
        assert_eq!(pose_of(&bench, command.pose.unwrap()), Some(expected), "{}", command.site.location);
        let (id, _) = bench.data.object(&command.object.unwrap(), command.grip).unwrap();
        assert_eq!(command.object_parameters, id);
    }
}

#[test]
fn bare_robot_goes_to_the_wanted_holster() {
    let mut bench = Bench::default();
    bench.world.emove.outputs.status.end_effector_id = None;
    bench.step();
    assert_eq!(bench.run(SubtaskVerb::GetEndeff, "PART", (1, 1), "PFIXTURE"), DONE);
    assert_eq!(bench.sent(), ["MOV-TO-HOL", "QC-ATTACH"]);
    assert!(
        bench
            .world
            .emove
            .received
            .iter()
            .all(|c| (c.object.as_ref().map_or("", Name16::as_str), c.grip) == ("GRIPPER-1", 2))
    );
}

#[test]
fn gripper_with_an_object_is_not_detached() {
    for held in ["BAR", "CYLINDER"] {
        let mut bench = Bench::default();
        bench.world.emove.hold(held, 1);
        bench.step();
        let end = bench.run(SubtaskVerb::GetEndeff, "CYLINDER", (1, 1), "PFIXTURE");
        assert_eq!(end, error(Reason::AlreadyHolding));
        assert!(bench.sent().is_empty());
    }
}

#[test]
fn exchange_failure_is_reported_with_its_reason() {
    for (verb, mishap, reason) in [
        (EmoveVerb::QcDetach, DeliveryFault::NoEffect, Reason::NotDetached),
        (EmoveVerb::QcAttach, DeliveryFault::NoEffect, Reason::NotAttached),
        (EmoveVerb::QcAttach, DeliveryFault::OtherGripper(3), Reason::WrongGripperId),
        (EmoveVerb::MovToHol, DeliveryFault::Error(Reason::NoTrajectory), Reason::NoTrajectory),
        (EmoveVerb::QcDetach, DeliveryFault::Error(Reason::QuickChangeStuck), Reason::QuickChangeStuck),
        (EmoveVerb::QcAttach, DeliveryFault::Silence, Reason::NeighbourLost),
    ] {
        let mut bench = Bench::default();
        bench.world.emove.mishap = Some((verb, mishap));
        let end = bench.run(SubtaskVerb::GetEndeff, "CYLINDER", (1, 1), "PFIXTURE");
        assert_eq!(end, error(reason), "{verb} {mishap:?}");
        let sent = bench.world.emove.received.len();
        (0..50).for_each(|_| assert_eq!(bench.step().status.report, StatusReport::Error));
        assert_eq!(bench.world.emove.received.len(), sent, "no order after an error");
    }
}

#[test]
fn gripper_without_holster_is_refused_before_any_motion() {
    for word in ["-o-loc- GRIPPER-1", "-o-loc- GRIPPER-2"] {
        let store = without(&[word]);
        let mut bench = Bench::of(store.view());
        let end = bench.run(SubtaskVerb::GetEndeff, "CYLINDER", (1, 1), "PFIXTURE");
        assert_eq!(end, error(Reason::NoHolster));
        assert!(bench.sent().is_empty());
    }
    // The test data have no grip to take the tool gripper out of its holster.
    let mut bench = Bench::default();
    assert_eq!(bench.run(SubtaskVerb::GetEndeff, "TOOL-1", (1, 1), ""), error(Reason::UnknownGrip));
    let mut bench = Bench::default();
    bench.world.emove.outputs.status.end_effector_id = None;
    bench.step();
    assert_eq!(bench.run(SubtaskVerb::GetEndeff, "GRIPPER-1", (1, 1), ""), error(Reason::NoHolster));
}

#[test]
fn object_is_regripped_on_the_pedestal() {
    let mut bench = Bench::grasped("PART", 1);
    assert_eq!(bench.run(SubtaskVerb::FixGrip, "PART", (1, -1), ""), DONE);
    assert_eq!(bench.sent(), ["MOV-OBJ-TO", "RELEASE", "MOV-TO-LOC", "MOV-TO-OBJ", "GRASP-OBJ"]);
    let aims: Vec<_> = bench
        .world
        .emove
        .received
        .iter()
        .map(|c| (c.object.as_ref().map_or("", Name16::as_str), c.grip, c.site.location.as_str()))
        .collect();
    let (bring, take) = (("PART", 1, "PEDESTAL"), ("PART", -1, "PEDESTAL"));
    assert_eq!(aims, [bring, bring, ("", 0, "PED-SAFE"), take, take]);
    for command in bench.world.emove.received.iter().filter(|c| c.object.is_some()) {
        let (id, _) = bench.data.object(&command.object.unwrap(), command.grip).unwrap();
        assert_eq!(command.object_parameters, id);
    }
    let told: Vec<_> = bench
        .world
        .pedestal
        .received
        .iter()
        .map(|c| (c.command, c.grasp_size, c.grasp_force, c.table_angle))
        .collect();
    assert_eq!(
        told,
        [
            (PedestalVerb::PreGrip, 500, 0, -2135),
            (PedestalVerb::Grip, 250, 50, 0),
            (PedestalVerb::Flip, 0, 0, 1835),
            (PedestalVerb::Release, 450, 0, 0),
        ]
    );
    assert!(bench.world.emove.outputs.status.held.is_held());
    // The goal is already reached.
    assert_eq!(bench.run(SubtaskVerb::FixGrip, "PART", (1, -1), ""), DONE);
    assert!(bench.sent().is_empty() && bench.sent_to_pedestal().is_empty());
}

#[test]
fn pedestal_command_carries_its_tick() {
    let mut bench = Bench::fixing();
    bench.step();
    let command = bench.memory.subtask.pedestal;
    assert_eq!((command.command, command.cycle), (PedestalVerb::PreGrip, bench.tick));
}

#[test]
fn pedestal_and_robot_never_move_together() {
    let mut bench = Bench::fixing();
    for _ in 0..200 {
        let status = bench.step().status;
        let robot = bench.memory.emove.status.report == StatusReport::Executing
            || bench.memory.subtask.emove.number != bench.memory.emove.status.echo;
        let pedestal = bench.memory.pedestal.status.report == PedestalReport::Executing
            || bench.memory.subtask.pedestal.number != bench.memory.pedestal.status.echo;
        assert!(!(robot && pedestal), "both move at tick {}", bench.tick);
        if status.report == StatusReport::Done {
            return;
        }
    }
    panic!("not done");
}

/// The number of commands that E-move has received when the pedestal fails at each of its four commands.
const BEFORE: [(PedestalVerb, usize); 4] = [
    (PedestalVerb::PreGrip, 0),
    (PedestalVerb::Grip, 1),
    (PedestalVerb::Flip, 3),
    (PedestalVerb::Release, 5),
];

#[test]
fn pedestal_failure_stops_the_robot() {
    for (verb, sent) in BEFORE {
        for (mishap, reason) in [
            (DeliveryFault::Special(Reason::None), Reason::PedestalCannot),
            (DeliveryFault::Special(Reason::TableLimit), Reason::TableLimit),
            (DeliveryFault::Error(Reason::None), Reason::PedestalError),
            (DeliveryFault::Error(Reason::TableStuck), Reason::TableStuck),
            (DeliveryFault::Silence, Reason::PedestalSilent),
        ] {
            let mut bench = Bench::grasped("PART", 1);
            bench.world.pedestal.mishap = Some((verb, mishap));
            let end = bench.run(SubtaskVerb::FixGrip, "PART", (1, -1), "");
            assert_eq!(end, error(reason), "{verb} {mishap:?}");
            (0..50).for_each(|_| assert_eq!(bench.step().status.report, StatusReport::Error));
            assert_eq!(bench.world.emove.received.len(), sent, "{verb}: no order to the robot after it");
            assert_eq!(bench.world.emove.outputs.status.held.is_held(), verb != PedestalVerb::Flip);
        }
    }
}

#[test]
fn robot_keeps_an_object_that_the_pedestal_missed() {
    let mut bench = Bench::grasped("PART", 1);
    bench.world.pedestal.part = 0;
    assert_eq!(bench.run(SubtaskVerb::FixGrip, "PART", (1, -1), ""), error(Reason::GraspMissed));
    assert_eq!(bench.sent(), ["MOV-OBJ-TO"]);
    let mut bench = Bench::grasped("PART", 1);
    bench.world.pedestal.slips = true;
    assert_eq!(bench.run(SubtaskVerb::FixGrip, "PART", (1, -1), ""), error(Reason::ObjectLost));
    assert_eq!(bench.sent(), ["MOV-OBJ-TO", "RELEASE", "MOV-TO-LOC"]);
}

#[test]
fn other_object_in_the_pedestal_prevents_the_regrip() {
    let mut bench = Bench::grasped("PART", 1);
    (bench.world.pedestal.outputs.status.felt, bench.world.pedestal.outputs.status.gripped) =
        (Felt::Something, true);
    bench.step();
    assert_eq!(bench.run(SubtaskVerb::FixGrip, "PART", (1, -1), ""), error(Reason::PedestalHoldsOther));
    assert!(bench.sent().is_empty());
    // The content of the robot's gripper is tested first.
    bench.world.emove.outputs.status.held = Holding::NotKnown;
    bench.step();
    assert_eq!(bench.run(SubtaskVerb::FixGrip, "PART", (1, -1), ""), error(Reason::HeldNotKnown));
}

#[test]
fn object_lost_during_a_regrip_is_reported() {
    for (verb, mishap, reason) in [
        (EmoveVerb::MovObjTo, DeliveryFault::Loss, Reason::ObjectLost),
        (EmoveVerb::GraspObj, DeliveryFault::NoEffect, Reason::GraspMissed),
        (EmoveVerb::MovToObj, DeliveryFault::Error(Reason::NoApproach), Reason::NoApproach),
    ] {
        let mut bench = Bench::grasped("PART", 1);
        bench.world.emove.mishap = Some((verb, mishap));
        assert_eq!(bench.run(SubtaskVerb::FixGrip, "PART", (1, -1), ""), error(reason));
    }
    // The robot loses the part while the pedestal prepares, and while it releases.
    for (verb, sent) in [(PedestalVerb::PreGrip, 0), (PedestalVerb::Release, 5)] {
        let mut bench = Bench::fixing();
        bench.world.emove.received.clear();
        bench.until(|bench| bench.memory.subtask.pedestal.command == verb);
        bench.world.emove.hold("", 0);
        assert_eq!(bench.finish(), error(Reason::ObjectLost));
        assert_eq!(bench.world.emove.received.len(), sent);
    }
}

#[test]
fn regrip_without_object_grip_or_pedestal_data_is_refused() {
    let mut bench = Bench::default();
    assert_eq!(bench.run(SubtaskVerb::FixGrip, "PART", (1, -1), ""), error(Reason::NothingHeld));
    assert_eq!(bench.run(SubtaskVerb::FixGrip, "", (1, -1), ""), error(Reason::NoObjectNamed));
    assert_eq!(bench.run(SubtaskVerb::FixGrip, "BAR", (1, 2), ""), error(Reason::NoPedestalData));
    assert_eq!(bench.run(SubtaskVerb::FixGrip, "PART", (1, 7), ""), error(Reason::UnknownGrip));
    let store = without(&["-pt-  PED-SAFE"]);
    let mut bench = Bench::of(store.view());
    assert_eq!(bench.run(SubtaskVerb::FixGrip, "PART", (1, -1), ""), error(Reason::UnknownLocation));
    // The part is held in neither the source grip nor the destination grip.
    let mut bench = Bench::grasped("PART", 2);
    assert_eq!(bench.run(SubtaskVerb::FixGrip, "PART", (1, -1), ""), error(Reason::RegripNeeded));
    bench.world.emove.hold("BAR", 1);
    bench.step();
    assert_eq!(bench.run(SubtaskVerb::FixGrip, "PART", (1, -1), ""), error(Reason::NothingHeld));
}

#[test]
fn object_is_placed_only_in_its_destination_grip() {
    for verb in [SubtaskVerb::PlaceObj, SubtaskVerb::MoveObjToDest] {
        let mut bench = Bench::grasped("PART", 1);
        assert_eq!(bench.run(verb, "PART", (1, 2), "PFIXTURE"), error(Reason::RegripNeeded));
        assert_eq!(bench.run(verb, "PART", (-1, 2), "PFIXTURE"), error(Reason::RegripNeeded));
        assert_eq!(bench.run(verb, "PART", (1, 1), "PFIXTURE"), DONE);
        // E-move reports the grip of the object, also to a restarted Subtask.
        let mut bench = Bench::grasped("PART", 1);
        bench.restart();
        bench.memory.subtask = SubtaskOutputs::default();
        bench.step();
        assert_eq!(bench.run(verb, "PART", (1, 2), "PFIXTURE"), error(Reason::RegripNeeded));
        assert_eq!(bench.run(verb, "PART", (2, 1), "PFIXTURE"), DONE);
        let mut bench = Bench::default();
        assert_eq!(bench.run(verb, "PART", (1, 1), "PFIXTURE"), error(Reason::NothingHeld));
    }
}

#[test]
fn tool_commands_carry_the_transfer_location() {
    for (verb, word, held) in [
        (SubtaskVerb::InsertTool, "INSERT-TOOL", true),
        (SubtaskVerb::ReleaseTool, "RELEASE-TOOL", true),
        (SubtaskVerb::AcquireTool, "ACQUIRE-TOOL", false),
        (SubtaskVerb::RemoveTool, "REMOVE-TOOL", true),
    ] {
        let mut bench = if held { Bench::grasped("TOOL-1", 1) } else { Bench::default() };
        assert_eq!(bench.run(verb, "TOOL-1", (1, 1), ""), DONE);
        assert_eq!(bench.sent(), [word]);
        let command = bench.world.emove.received[0];
        assert_eq!(
            (command.object.unwrap_or_default().as_str(), command.site.location.as_str()),
            ("TOOL-1", "TOOL-TRNS")
        );
        assert_eq!((command.grip, command.end_effector_id), (1, Some(3)));
        assert_eq!(command.pose.unwrap() & pose_range::WRITER, pose_range::SUBTASK);
        let tool = Name16::new("TOOL-1").unwrap();
        assert_eq!(command.object_parameters, bench.data.object(&tool, 1).unwrap().0);
        assert_eq!(bench.memory.emove.status.held.is_held(), verb != SubtaskVerb::ReleaseTool);
    }
}

#[test]
fn tool_failure_is_reported_with_its_reason() {
    let (insert, release) = (EmoveVerb::InsertTool, EmoveVerb::ReleaseTool);
    let (acquire, remove) = (EmoveVerb::AcquireTool, EmoveVerb::RemoveTool);
    for (emove, mishap, reason) in [
        (insert, DeliveryFault::Loss, Reason::ObjectLost),
        (remove, DeliveryFault::Loss, Reason::ObjectLost),
        (acquire, DeliveryFault::NoEffect, Reason::GraspMissed),
        (insert, DeliveryFault::Error(Reason::Detected), Reason::Detected),
        (remove, DeliveryFault::Error(Reason::Detected), Reason::Detected),
        (release, DeliveryFault::Error(Reason::NotDetected), Reason::NotDetected),
        (acquire, DeliveryFault::Error(Reason::SensorError), Reason::SensorError),
    ] {
        let mut bench = if emove == acquire { Bench::default() } else { Bench::grasped("TOOL-1", 1) };
        bench.world.emove.mishap = Some((emove, mishap));
        // A tool command is one order of the same name.
        let verb = SubtaskVerb::ALL.iter().find(|verb| verb.text() == emove.text()).unwrap();
        assert_eq!(bench.run(*verb, "TOOL-1", (1, 1), ""), error(reason), "{verb}");
    }
    for verb in [SubtaskVerb::InsertTool, SubtaskVerb::ReleaseTool, SubtaskVerb::RemoveTool] {
        let mut bench = Bench::default();
        assert_eq!(bench.run(SubtaskVerb::GotoDest, "", (0, 0), "SAFE"), DONE);
        assert_eq!(bench.run(verb, "TOOL-1", (1, 1), ""), error(Reason::NothingHeld), "{verb}");
    }
    let mut bench = Bench::grasped("TOOL-1", 1);
    assert_eq!(bench.run(SubtaskVerb::AcquireTool, "TOOL-1", (1, 1), ""), DONE);
    assert_eq!(bench.sent(), ["ACQUIRE-TOOL"], "E-move senses whether the tool is in the drum");
    assert_eq!(bench.run(SubtaskVerb::AcquireTool, "PART", (1, 1), ""), error(Reason::AlreadyHolding));
    let store = without(&["-pt-  TOOL-TRNS", "TRNS-TOOLS"]);
    let mut bench = Bench::of(store.view());
    assert_eq!(bench.run(SubtaskVerb::AcquireTool, "TOOL-1", (1, 1), ""), error(Reason::UnknownLocation));
}

#[test]
fn object_with_vision_data_is_located_by_vision() {
    let mut bench = Bench::default();
    assert_eq!(bench.run(SubtaskVerb::GetObject, "BAR", (1, 1), "UNIT_1"), DONE);
    assert_eq!(bench.sent(), ["MOV-TO-VU", "LOCATE-OBJ", "MOV-TO-OBJ", "GRASP-OBJ"]);
    let (told, bar) = (bench.memory.task.subtask, Name16::new("BAR").unwrap());
    for command in &bench.world.emove.received {
        assert_eq!((command.site.kind, command.site), (LocationKind::Point, told.site));
        assert_eq!(command.object_vision, bench.data.view(&bar, &told.site.place()).unwrap().0);
        assert_eq!(command.object_grips, bench.data.obj_grips_id(&bar).unwrap());
    }
    assert_eq!(bench.run(SubtaskVerb::GetObject, "BAR", (1, 1), "UNIT_1"), DONE);
    assert_eq!(bench.sent(), ["GRASP-OBJ"], "the object is held already");
    let end = bench.run(SubtaskVerb::GetObject, "PART", (1, 1), "PFIXTURE");
    assert_eq!(end, error(Reason::AlreadyHolding));
    let mut bench = Bench::default();
    bench.world.emove.mishap = Some((EmoveVerb::LocateObj, DeliveryFault::Error(Reason::NothingSeen)));
    let end = bench.run(SubtaskVerb::GetObject, "BAR", (1, 1), "UNIT_1");
    assert_eq!(end, error(Reason::NothingSeen));
    let mut bench = Bench::default();
    bench.world.emove.mishap = Some((EmoveVerb::GraspObj, DeliveryFault::NoEffect));
    let end = bench.run(SubtaskVerb::GetObject, "PART", (1, 1), "PFIXTURE");
    assert_eq!(end, error(Reason::GraspMissed));
    assert_eq!(bench.sent(), ["MOV-TO-OBJ", "GRASP-OBJ"]);
}

#[test]
fn other_commands_send_their_elemental_moves() {
    let mut bench = Bench::grasped("PART", 1);
    assert_eq!(bench.run(SubtaskVerb::PlaceObj, "PART", (1, 1), "PFIXTURE"), DONE);
    assert_eq!(bench.sent(), ["MOV-OBJ-TO", "RELEASE"]);
    for verb in [SubtaskVerb::GotoDest, SubtaskVerb::GotoEndpt] {
        assert_eq!(bench.run(verb, "", (0, 0), "SAFE"), DONE);
        assert_eq!(bench.sent(), ["MOV-TO-LOC"]);
    }
    assert_eq!(bench.run(SubtaskVerb::Position, "PART", (0, -1), "PFIXTURE"), DONE);
    assert_eq!((bench.sent(), bench.world.emove.received[0].grip), (vec!["MOV-TO-OBJ"], -1));
    assert_eq!(bench.run(SubtaskVerb::Position, "", (0, 0), "SAFE"), DONE);
    assert_eq!(bench.sent(), ["MOV-TO-LOC"]);
    assert_eq!(bench.run(SubtaskVerb::Release, "PART", (1, 1), ""), DONE);
    assert_eq!(bench.sent(), ["RELEASE"]);
    assert_eq!(bench.run(SubtaskVerb::Pause, "", (0, 0), ""), DONE);
    assert_eq!((bench.sent(), bench.sent_to_pedestal()), (vec!["E-PAUSE"], vec![]));
    assert_eq!(bench.run(SubtaskVerb::None, "", (0, 0), ""), error(Reason::UnknownCommand));
}

#[test]
fn object_lost_during_a_motion_is_reported() {
    for verb in [SubtaskVerb::PlaceObj, SubtaskVerb::MoveObjToDest] {
        let mut bench = Bench::grasped("PART", 1);
        bench.world.emove.mishap = Some((EmoveVerb::MovObjTo, DeliveryFault::Loss));
        assert_eq!(bench.run(verb, "PART", (1, 1), "PFIXTURE"), error(Reason::ObjectLost));
    }
}

#[test]
fn error_of_e_move_is_passed_up_by_every_command() {
    for (verb, emove, object) in [
        (SubtaskVerb::PlaceObj, EmoveVerb::MovObjTo, "PART"),
        (SubtaskVerb::MoveObjToDest, EmoveVerb::MovObjTo, "PART"),
        (SubtaskVerb::GotoDest, EmoveVerb::MovToLoc, ""),
        (SubtaskVerb::Position, EmoveVerb::MovToLoc, ""),
        (SubtaskVerb::Release, EmoveVerb::Release, "PART"),
        (SubtaskVerb::Pause, EmoveVerb::Pause, ""),
    ] {
        let mut bench = Bench::grasped("PART", 1);
        bench.world.emove.mishap = Some((emove, DeliveryFault::Error(Reason::NotAtGoal)));
        assert_eq!(bench.run(verb, object, (1, 1), "SAFE"), error(Reason::NotAtGoal), "{verb}");
    }
}

#[test]
fn pause_stops_a_moving_pedestal() {
    let mut bench = Bench::grasped("PART", 1);
    bench.world.pedestal.mishap = Some((PedestalVerb::Flip, DeliveryFault::Hang));
    bench.command(SubtaskVerb::FixGrip, "PART", (1, -1), "");
    (0..100).for_each(|_| assert_eq!(bench.step().status.report, StatusReport::Executing));
    assert_eq!(bench.run(SubtaskVerb::Pause, "", (0, 0), ""), DONE);
    assert_eq!((bench.sent(), bench.sent_to_pedestal()), (vec!["E-PAUSE"], vec!["PAUSE"]));
    assert_eq!(bench.run(SubtaskVerb::Pause, "", (0, 0), ""), DONE);
    assert!(bench.sent_to_pedestal().is_empty(), "it pauses already");
}

#[test]
fn active_joystick_is_reported() {
    let mut bench = Bench::default();
    bench.world.emove.mishap = Some((EmoveVerb::MovToLoc, DeliveryFault::Special(Reason::JoystickOn)));
    let end = bench.run(SubtaskVerb::GotoDest, "", (0, 0), "SAFE");
    assert_eq!(end, (StatusReport::JoystickOn, Reason::JoystickOn));
    (0..20).for_each(|_| assert_eq!(bench.step().status.report, StatusReport::JoystickOn));
    bench.world.emove.outputs.status.report = StatusReport::Done;
    bench.step();
    let status = bench.step().status;
    assert_eq!((status.report, status.reason), (StatusReport::Error, Reason::JoystickOn));
    // The report is the same while no command is executing.
    bench.world.emove.mishap = None;
    assert_eq!(bench.run(SubtaskVerb::GotoDest, "", (0, 0), "SAFE"), DONE);
    bench.world.emove.outputs.status.report = StatusReport::JoystickOn;
    bench.step();
    assert_eq!(bench.step().status.report, StatusReport::JoystickOn);
    bench.world.emove.outputs.status.report = StatusReport::Done;
    bench.step();
    assert_eq!(bench.step().status.report, StatusReport::Done);
}

#[test]
fn place_and_held_object_are_passed_up() {
    let mut bench = Bench::grasped("PART", 1);
    bench.world.emove.outputs.status.reference_pose = Some(0x8300_0007);
    assert_eq!(bench.run(SubtaskVerb::MoveObjToDest, "PART", (1, 1), "SAFE"), DONE);
    let status = bench.memory.subtask.status;
    assert_eq!(status.reference_pose, Some(0x8300_0007));
    assert_eq!(
        (status.at.unwrap().site.location.as_str(), status.held.object()),
        ("SAFE", Name16::new("PART").ok())
    );
    assert_eq!(status.end_effector_id, Some(1));
}

#[test]
fn every_row_of_every_table_fires() {
    const SCENARIOS: &[fn()] = &[
        gripper_without_holster_is_refused_before_any_motion,
        pedestal_failure_stops_the_robot,
        robot_keeps_an_object_that_the_pedestal_missed,
        regrip_without_object_grip_or_pedestal_data_is_refused,
        tool_commands_carry_the_transfer_location,
        tool_failure_is_reported_with_its_reason,
        other_commands_send_their_elemental_moves,
        object_lost_during_a_motion_is_reported,
    ];
    let silent = silent::<Subtask, TaskData<'_>>(&[SCENARIOS, recovery::SCENARIOS].concat());
    // The locations that Subtask names itself are location points, which need neither object nor sector.
    assert_eq!(silent, ["ACCEPT 8", "ACCEPT 9", "ACCEPT 10", "ACCEPT 11", "ACCEPT 12"]);
}
