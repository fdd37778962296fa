use geometry::{frame::Vector, pose::Pose};
use interfaces::{
    Reason, StatusReport,
    device::VisionStatus,
    emove::EmoveVerb::{
        GraspObj, InsertTool, LocateObj, MovObjTo, MovToHol, MovToLoc, MovToObj, MovToVu, Release,
        RemoveTool, Withdraw,
    },
    jaws::JawsReport,
    pose_range,
    prim::{PrimReport, PrimVerb},
    process::Process as _,
};
use rcs_core::name::Name16;
use taskdata::files::{LocptId, PathPoint, Target};

use super::{
    bench::{Bench, DONE, data, error, frame_of, moved},
    doubles::DeliveryFault,
};
use crate::emove::localization::surroundings::Surroundings;

pub const SCENARIOS: &[fn()] = &[
    parts_gripper_fetches_places_and_releases_a_part,
    fingers_open_only_after_the_depart_points,
    gripper_failure_stops_the_motion,
    lost_part_is_reported_with_each_gripper,
    command_for_another_gripper_is_refused,
    object_at_the_edge_of_its_tray_is_refused,
    failed_picture_is_retried_and_then_reported,
    implausible_picture_moves_nothing,
    withdraw_moves_the_robot_clear,
    missing_data_are_reported,
];

/// Gripper, an object for it, and its size, 0.01 in.
const PARTS: [(u8, &str, i32); 3] = [(1, "BLOCK", 75), (2, "SHAFT", 204), (3, "CUTTER", 246)];

#[test]
fn robot_moves_with_each_gripper_and_without_one() {
    for gripper in 0..=3 {
        let mut bench = Bench::ready("HOME", gripper);
        assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), DONE);
        assert_eq!(bench.log(), ["GO-THRU", "GO-THRU", "GOTO-PT"], "no gripper commands");
        assert!(bench.off(&frame_of("VISE")) < 0.02);
        assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), DONE);
        assert!(bench.off(&frame_of("HOME")) < 0.02);
        assert_eq!(bench.at(), "HOME");
    }
}

#[test]
fn move_to_the_present_location_is_done_at_once() {
    let mut bench = Bench::ready("HOME", 0);
    assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), DONE);
    assert!(bench.log().is_empty());
}

#[test]
fn robot_passing_a_through_point_stays_on_its_path() {
    let mut bench = Bench::ready("HOME", 0);
    bench.world.prim.by_steps = true;
    bench.command(MovToLoc, "", 0, "VISE", 0);
    let mut passed = 0;
    for _ in 0..1000 {
        bench.step();
        let moves = matches!(bench.memory.emove.prim.command, PrimVerb::GoThru | PrimVerb::GotoPt);
        // The moving arm lags farther behind than a robot at rest may be off its way.
        bench.world.prim.sag = Vector::new(if moves { 1.0 } else { 0.0 }, 0.0, 0.0);
        if bench.memory.emove.prim.command == PrimVerb::GotoPt {
            assert!(passed > 1, "{:?}", bench.world.log);
            return;
        }
        passed += u32::from(moves && bench.memory.prim.status.report == PrimReport::Done);
        let around = *bench.process.state().localization.surroundings();
        assert_eq!(around, Surroundings::default(), "no search for the place: {:?}", bench.world.log);
    }
    panic!("the robot never arrives: {:?}", bench.world.log);
}

#[test]
fn static_pose_record_is_a_valid_goal() {
    let mut bench = Bench::ready("HOME", 0);
    bench.command(MovToLoc, "", 0, "VISE", 0);
    bench.memory.subtask.emove.pose = data().pose_named(&Name16::clipped("VISE-P")).map(|id| id.number());
    assert_eq!(bench.finish(), DONE);
    assert!(bench.off(&frame_of("VISE")) < 0.02);
}

#[test]
fn parts_gripper_fetches_places_and_releases_a_part() {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.run(MovToObj, "BLOCK", 1, "BENCH", 1), DONE);
    assert_eq!(bench.log(), ["POSITION", "GO-THRU", "GO-THRU", "GO-THRU A/D-5", "GOTO-PT"]);
    assert!(bench.off(&moved(frame_of("BENCH"), &["GRASP-MTB"])) < 0.02);
    bench.world.object = Some(75);
    assert_eq!(bench.run(GraspObj, "BLOCK", 1, "BENCH", 1), DONE);
    assert_eq!(bench.log(), ["CLOSE-GRIP"]);
    let command = bench.memory.emove.grip;
    assert_eq!((command.position, command.force, command.end_effector_id), (60, 30, Some(1)));
    assert!(bench.memory.emove.status.held.is_held());
    assert_eq!(bench.run(GraspObj, "BLOCK", 1, "BENCH", 1), DONE, "the part is held");
    assert!(bench.log().is_empty());
    assert_eq!(bench.run(MovToObj, "BLOCK", 1, "BENCH", 1), DONE, "the robot approached with this grip");
    assert!(bench.log().is_empty());
    assert_eq!(bench.run(MovObjTo, "BLOCK", 1, "VISE", 1), DONE);
    assert_eq!(bench.log(), ["GO-THRU A/D-5", "GO-THRU", "GO-THRU A/D-5", "GOTO-PT"]);
    assert_eq!(bench.run(MovObjTo, "BLOCK", 1, "VISE", 1), DONE, "the part is there");
    assert!(bench.log().is_empty());
    assert_eq!(bench.run(Release, "BLOCK", 1, "VISE", 1), DONE);
    assert_eq!(bench.log(), ["OPEN-GRIP"]);
    assert_eq!((bench.memory.emove.grip.position, bench.memory.emove.status.held.is_held()), (350, false));
    assert_eq!(bench.run(Release, "BLOCK", 1, "VISE", 1), DONE, "the fingers are empty and open");
    assert!(bench.log().is_empty());
    assert_eq!(bench.run(MovToObj, "BLOCK", 1, "VISE", 1), DONE);
    assert_eq!(bench.log(), ["POSITION"], "the robot is there, but the fingers are not at their opening");
}

#[test]
fn jaws_fetch_place_and_release_their_parts() {
    for (gripper, object, size, opened, stop) in
        [(2, "SHAFT", 204, "POSE 350", 350), (3, "CUTTER", 246, "POSE 400", 400)]
    {
        let mut bench = Bench::ready("HOME", gripper);
        (bench.world.v_grip.opening, bench.world.tool_grip.opening) = (50, 100);
        assert_eq!(bench.run(MovToObj, object, 1, "BENCH", gripper), DONE);
        assert_eq!(bench.log(), [opened, "GO-THRU", "GO-THRU", "GOTO-PT"]);
        bench.world.object = Some(size);
        assert_eq!(bench.run(GraspObj, object, 1, "BENCH", gripper), DONE);
        assert_eq!(bench.log(), [format!("GRASP {}", if gripper == 2 { 200 } else { 250 })]);
        assert_eq!(bench.pause(), DONE, "a pause keeps the part held");
        assert!(bench.memory.emove.status.held.is_held());
        assert_eq!(bench.run(MovObjTo, object, 1, "VISE", gripper), DONE);
        assert_eq!(bench.run(Release, object, 1, "VISE", gripper), DONE);
        assert_eq!(bench.log(), [format!("RELEASE {}", if gripper == 2 { 350 } else { 400 })]);
        assert!(!bench.memory.emove.status.held.is_held());
        assert_eq!(bench.run(Release, object, 1, "VISE", gripper), DONE);
        assert!(bench.log().is_empty());
        let opening = if gripper == 2 { bench.world.v_grip.opening } else { bench.world.tool_grip.opening };
        assert_eq!(opening, stop);
    }
}

#[test]
fn fingers_at_their_opening_are_not_commanded() {
    let mut bench = Bench::ready("HOME", 1);
    bench.world.grip.opening = 300;
    assert_eq!(bench.run(MovToObj, "BLOCK", 1, "BENCH", 1), DONE);
    assert!(!bench.log().contains(&"POSITION"));
    let mut bench = Bench::ready("HOME", 2);
    bench.world.v_grip.opening = 350;
    assert_eq!(bench.run(MovToObj, "SHAFT", 1, "BENCH", 2), DONE);
    assert!(!bench.log().contains(&"POSE 350"));
}

#[test]
fn fingers_open_only_after_the_depart_points() {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.run(MovToObj, "BLOCK", 1, "BENCH", 1), DONE);
    assert_eq!(bench.run(Release, "BLOCK", 1, "BENCH", 1), DONE);
    assert_eq!(bench.run(MovToObj, "BLOCK", 1, "VISE", 1), DONE);
    assert_eq!(bench.log(), ["GO-THRU A/D-5", "POSITION", "GO-THRU", "GO-THRU A/D-5", "GOTO-PT"]);
    bench.hold("BLOCK", 75, 1);
    assert_eq!(bench.run(MovToObj, "PIN", 1, "BENCH", 1), error(Reason::AlreadyHolding));
    assert_eq!(bench.run(MovToVu, "PIN", 1, "BENCH", 1), error(Reason::BadRecord), "PIN has no view");
    assert_eq!(bench.run(GraspObj, "PIN", 1, "BENCH", 1), error(Reason::AlreadyHolding));
    assert_eq!(bench.run(MovToHol, "GRIPPER-1", 1, "HOLSTER-R", 1), error(Reason::NoTrajectory));
    assert!(bench.memory.emove.status.held.is_held());
}

#[test]
fn gripper_failure_stops_the_motion() {
    let mut bench = Bench::ready("HOME", 1);
    bench.spoil("POSITION", DeliveryFault::Grip(Reason::GripTimeout));
    assert_eq!(bench.run(MovToObj, "BLOCK", 1, "BENCH", 1), error(Reason::GripTimeout));
    bench.step();
    assert_eq!(bench.log().last(), Some(&"PAUSE"), "the robot stops");
    let mut bench = Bench::ready("HOME", 2);
    bench.world.v_grip.opening = 50;
    bench.spoil("POSE", DeliveryFault::Jaws(JawsReport::Closed));
    assert_eq!(
        bench.run(MovToObj, "SHAFT", 1, "BENCH", 2),
        error(Reason::JawsStuck),
        "the jaws did not move"
    );
    let mut bench = Bench::ready("HOME", 2);
    bench.world.object = Some(250);
    assert_eq!(bench.run(GraspObj, "SHAFT", 1, "BENCH", 2), error(Reason::JawsStuck), "another size");
    let mut bench = Bench::ready("HOME", 2);
    bench.spoil("GRASP", DeliveryFault::Jaws(JawsReport::Opened));
    assert_eq!(bench.run(GraspObj, "SHAFT", 1, "BENCH", 2), error(Reason::JawsStuck));
    bench.world.object = Some(200);
    bench.world.mishaps.clear();
    bench.hold("SHAFT", 200, 2);
    bench.spoil("RELEASE", DeliveryFault::Jaws(JawsReport::Stuck));
    assert_eq!(bench.run(Release, "SHAFT", 1, "BENCH", 2), error(Reason::JawsStuck));
    let mut bench = Bench::ready("HOME", 1);
    bench.world.dead.push("gripper");
    assert_eq!(bench.run(GraspObj, "BLOCK", 1, "BENCH", 1), error(Reason::NeighbourLost));
    let mut bench = Bench::ready("HOME", 1);
    bench.command(MovToObj, "BLOCK", 1, "BENCH", 1);
    bench.wait(5);
    bench.world.mated = 0;
    assert_eq!(bench.finish(), error(Reason::WrongGripper), "the gripper is gone");
}

#[test]
fn failure_of_prim_is_passed_up() {
    for (report, reason) in [
        (PrimReport::T3LinkOff, Reason::LinkOff),
        (PrimReport::T3LinkErr, Reason::LinkError),
        (PrimReport::NoRespT3i, Reason::InterfaceSilent),
        (PrimReport::T3BadCommand, Reason::InterfaceRefused),
        (PrimReport::SensorError, Reason::SensorError),
        (PrimReport::Error, Reason::NotAtGoal),
    ] {
        for (verb, object, gripper) in
            [(MovToLoc, "", 0), (MovToObj, "BLOCK", 1), (MovToHol, "GRIPPER-1", 1), (MovObjTo, "BLOCK", 1)]
        {
            let mut bench = Bench::ready("HOME", gripper);
            if verb == MovObjTo {
                bench.hold("BLOCK", 75, 1);
            }
            let location = if verb == MovToHol { "HOLSTER-R" } else { "BENCH" };
            bench.spoil("GO-THRU", DeliveryFault::Prim(report, reason));
            assert_eq!(bench.run(verb, object, 1, location, gripper), error(reason), "{verb}");
            assert!(bench.memory.emove.status.at.is_none(), "the robot's place is unknown");
        }
    }
    let mut bench = Bench::ready("HOME", 0);
    bench.world.dead.push("Prim");
    assert_eq!(bench.run(MovToLoc, "", 0, "BENCH", 0), error(Reason::NeighbourLost));
    let mut bench = Bench::ready("HOME", 0);
    bench.spoil("GOTO-PT", DeliveryFault::Joystick);
    assert_eq!(bench.run(MovToLoc, "", 0, "BENCH", 0), (StatusReport::JoystickOn, Reason::JoystickOn));
}

#[test]
fn lost_part_is_reported_with_each_gripper() {
    for (gripper, object, size) in PARTS {
        for verb in [MovObjTo, MovToLoc] {
            for gone in [DeliveryFault::Slip, DeliveryFault::AttachedGripper(0)] {
                let mut bench = Bench::ready("HOME", gripper);
                bench.hold(object, size, gripper);
                bench.command(verb, object, 1, "VISE", gripper);
                bench.wait(6);
                match gone {
                    DeliveryFault::Slip => {
                        (
                            bench.world.grip.opening,
                            bench.world.v_grip.opening,
                            bench.world.tool_grip.opening,
                        ) = (60, 50, 100);
                    }
                    _ => (bench.world.mated, bench.world.locked) = (0, false),
                }
                let reason = if matches!(gone, DeliveryFault::Slip) {
                    Reason::ObjectLost
                } else {
                    Reason::GripperGone
                };
                assert_eq!(bench.finish(), error(reason), "{object} {verb}");
                assert!(!bench.memory.emove.status.held.is_held());
            }
        }
        let mut bench = Bench::ready("HOME", gripper);
        bench.hold(object, size, gripper);
        (bench.world.grip.opening, bench.world.v_grip.opening, bench.world.tool_grip.opening) =
            (size + 30, size + 30, size + 30);
        bench.wait(3);
        assert!(bench.memory.emove.status.held.object().is_none(), "fingers opened wider have lost the part");
        assert_eq!(bench.run(MovObjTo, object, 1, "VISE", gripper), error(Reason::NothingHeld));
    }
}

#[test]
fn part_without_contact_force_is_lost() {
    let mut bench = Bench::ready("HOME", 1);
    bench.hold("BLOCK", 100, 1);
    bench.command(MovObjTo, "BLOCK", 1, "VISE", 1);
    bench.wait(6);
    // A short dip is not a loss, but noise or a part that is pushed to the other finger.
    bench.world.grip.force = 0;
    bench.wait(3);
    bench.world.grip.force = 30;
    bench.wait(3);
    assert!(bench.memory.emove.status.held.is_held());
    // The fingers hardly move when a part falls that was held with little force.
    bench.world.grip.force = 0;
    assert_eq!(bench.finish(), error(Reason::ObjectLost));
    assert!(!bench.memory.emove.status.held.is_held());
}

#[test]
fn command_for_another_gripper_is_refused() {
    for (verb, location) in [
        (MovToObj, "BENCH"),
        (MovObjTo, "BENCH"),
        (MovToVu, "BENCH"),
        (LocateObj, "BENCH"),
        (GraspObj, "BENCH"),
        (InsertTool, "TOOL-TRNS"),
        (RemoveTool, "TOOL-TRNS"),
    ] {
        for attached in [0, 2, 3] {
            let mut bench = Bench::ready("HOME", attached);
            assert_eq!(bench.run(verb, "BLOCK", 1, location, 1), error(Reason::WrongGripper), "{verb}");
            bench.wait(3);
            assert!(bench.log().is_empty(), "no order was active");
        }
    }
    let mut bench = Bench::ready("HOME", 2);
    assert_eq!(bench.run(MovToHol, "GRIPPER-1", 1, "HOLSTER-R", 1), error(Reason::WrongGripper));
}

#[test]
fn missed_grasp_is_reported() {
    for (gripper, object, _) in PARTS {
        let mut bench = Bench::ready("HOME", gripper);
        assert_eq!(bench.run(GraspObj, object, 1, "BENCH", gripper), error(Reason::GraspMissed));
        assert!(!bench.memory.emove.status.held.is_held());
    }
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.run(GraspObj, "BLOCK", 7, "BENCH", 1), error(Reason::UnknownGrip));
}

#[test]
fn release_without_an_object_opens_or_is_done_at_once() {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.run(Release, "BLOCK", 1, "", 1), DONE);
    assert_eq!(bench.log(), ["OPEN-GRIP"], "the fingers were narrow");
    let mut bench = Bench::ready("HOME", 0);
    assert_eq!(bench.run(Release, "", 0, "", 0), DONE);
    assert!(bench.log().is_empty(), "a bare robot holds nothing");
    let mut bench = Bench::ready("HOME", 1);
    bench.spoil("OPEN-GRIP", DeliveryFault::Grip(Reason::None));
    assert_eq!(bench.run(Release, "BLOCK", 1, "", 1), error(Reason::GripUnattainable));
    // The present gripper releases the held object with the object's own depart size.
    let mut bench = Bench::ready("HOME", 1);
    bench.hold("BLOCK", 75, 1);
    assert_eq!(bench.run(Release, "CUTTER", 1, "", 3), DONE);
    assert_eq!(bench.memory.emove.grip.position, 350);
}

#[test]
fn vision_locates_an_object() {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.run(MovToVu, "BLOCK", 1, "BENCH", 1), DONE);
    assert_eq!(bench.log(), ["POSITION", "GO-THRU", "GO-THRU", "GOTO-PT"]);
    assert_eq!(bench.memory.emove.grip.position, 500, "the camera looks between open fingers");
    assert!(bench.off(&moved(frame_of("BENCH"), &["GR-PIC"])) < 0.02);
    assert_eq!(bench.run(LocateObj, "BLOCK", 1, "BENCH", 1), DONE);
    assert_eq!(bench.log(), ["flood 0", "GOTO-PT", "precise 0", "GOTO-PT"]);
    // Two answers of (0.20, -0.10) in, and a turn of 10 degrees.
    assert_eq!(bench.run(MovToObj, "BLOCK", 1, "BENCH", 1), DONE);
    let distance = bench.world.frame.distance(&moved(frame_of("BENCH"), &["GRASP-MTB"]));
    assert!((distance.inches - 0.2_f64.hypot(0.1) * 2.0).abs() < 0.03, "{} in", distance.inches);
    assert!((distance.radians.to_degrees() - 10.0).abs() < 0.1, "{} rad", distance.radians);
    assert_eq!(bench.run(MovToVu, "SHAFT", 1, "BENCH", 0), error(Reason::BadRecord));
    // An interrupted grasp has ended since, so the robot must not drag the part to the place of the picture.
    bench.hold("BLOCK", 75, 1);
    assert_eq!(bench.run(MovToVu, "BLOCK", 1, "BENCH", 1), error(Reason::AlreadyHolding));
    assert_eq!(bench.run(LocateObj, "BLOCK", 1, "BENCH", 1), error(Reason::AlreadyHolding));
    assert!(!bench.log().iter().any(|word| word.starts_with("GO")), "{:?}", bench.log());
}

/// A slot is 8.00 in by 9.00 in, and the open fingers are 4.00 in by 1.50 in. SLOT is a tray of one; SLOTS has three
/// more towards -Y and -Z of the tool.
#[test]
fn object_at_the_edge_of_its_tray_is_refused() {
    let outside = error(Reason::AtTrayEdge);
    // The block lies twice as far from the middle as each of the two pictures reports.
    for (array, (y, z, angle), end) in [
        ("SLOT", (98, 0, 0), DONE),
        ("SLOT", (102, 0, 0), outside),
        ("SLOT", (-98, 0, 0), DONE),
        ("SLOT", (-102, 0, 0), outside),
        ("SLOT", (0, 186, 0), DONE),
        ("SLOT", (0, 189, 0), outside),
        ("SLOT", (0, -189, 0), outside),
        // Turned by a quarter, the fingers open along the longer side.
        ("SLOT", (161, 0, 9_000), DONE),
        ("SLOT", (164, 0, 9_000), outside),
        ("SLOT", (0, -124, -9_000), DONE),
        ("SLOT", (0, -126, -9_000), outside),
        ("SLOTS", (98, 186, 0), DONE),
        ("SLOTS", (102, 0, 0), outside),
        ("SLOTS", (0, 189, 0), outside),
        ("SLOTS", (-102, -189, 0), DONE),
        ("", (200, 200, 0), DONE),
    ] {
        let mut bench = Bench::ready("HOME", 1);
        assert_eq!(bench.run(MovToVu, "BLOCK", 1, "BENCH", 1), DONE);
        bench.world.claims = vec![(y, z, 0, 0), (y, z, angle, 17)];
        bench.command(LocateObj, "BLOCK", 1, "BENCH", 1);
        let array_id = data().array_named(&Name16::clipped(array));
        bench.memory.subtask.emove.site.array = array_id.unwrap_or_default();
        assert_eq!(bench.finish(), end, "{array} {y} {z} {angle}");
        assert_eq!(
            bench.memory.emove.estimates.located.is_some(),
            end == DONE,
            "the next command takes a new picture"
        );
    }
}

/// The object located in one sector does not apply to a command for another sector of the tray.
#[test]
fn located_object_is_valid_only_in_its_sector() {
    let mut bench = Bench::ready("HOME", 1);
    let array = data().array_named(&Name16::clipped("SLOTS")).unwrap_or_default();
    assert_eq!(bench.run(MovToVu, "BLOCK", 1, "BENCH", 1), DONE);
    bench.command(LocateObj, "BLOCK", 1, "BENCH", 1);
    let told = &mut bench.memory.subtask.emove;
    (told.site.array, told.site.sector) = (array, Some(1));
    assert_eq!(bench.finish(), DONE);
    bench.command(MovToObj, "BLOCK", 1, "BENCH", 1);
    let mut there = frame_of("BENCH");
    there.position.y += 3.0;
    let pose = &mut bench.memory.subtask.poses[0];
    pose.number = Some(pose_range::next(pose_range::SUBTASK, pose.number.unwrap_or_default()));
    pose.pose = Pose::from_frame(&there);
    let told = &mut bench.memory.subtask.emove;
    (told.site.array, told.site.sector, told.pose) = (array, Some(2), pose.number);
    assert_eq!(bench.finish(), DONE);
    let off = bench.world.frame.distance(&moved(there, &["GRASP-MTB"])).inches;
    assert!(off < 0.1, "{off} in from the goal of the command");
}

#[test]
fn failed_picture_is_retried_and_then_reported() {
    use VisionStatus::{Done, NotRecognised, NothingSeen};
    for (answers, end, log) in [
        (vec![NothingSeen, Done, NotRecognised, NothingSeen, Done], DONE, 7),
        (vec![NothingSeen; 3], error(Reason::NothingSeen), 3),
        (vec![NotRecognised; 3], error(Reason::NothingSeen), 3),
        (vec![Done, NothingSeen, NothingSeen, NothingSeen], error(Reason::NothingSeen), 5),
        (vec![Done, NotRecognised, NotRecognised, NotRecognised], error(Reason::NotRecognised), 5),
    ] {
        let mut bench = Bench::ready("HOME", 1);
        assert_eq!(bench.run(MovToVu, "BLOCK", 1, "BENCH", 1), DONE);
        bench.world.answers.clone_from(&answers);
        assert_eq!(bench.run(LocateObj, "BLOCK", 1, "BENCH", 1), end, "{answers:?}");
        assert_eq!(bench.log().len(), log, "{:?}", bench.log());
    }
    let mut bench = Bench::ready("HOME", 1);
    bench.world.dead.push("vision");
    assert_eq!(bench.run(LocateObj, "BLOCK", 1, "BENCH", 1), error(Reason::VisionSilent));
    let mut bench = Bench::ready("HOME", 1);
    bench.world.dead.push("Prim");
    bench.memory.prim.status.sensor_pose = None;
    assert_eq!(
        bench.run(LocateObj, "BLOCK", 1, "BENCH", 1),
        error(Reason::BadRecord),
        "the resolvers give no position of the camera"
    );
    let mut bench = Bench::ready("HOME", 1);
    bench.spoil("GOTO-PT", DeliveryFault::Prim(PrimReport::Error, Reason::NotAtGoal));
    assert_eq!(bench.run(LocateObj, "BLOCK", 1, "BENCH", 1), error(Reason::NotAtGoal));
}

#[test]
fn picture_from_a_sinking_arm_is_discarded() {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.run(MovToVu, "BLOCK", 1, "BENCH", 1), DONE);
    bench.world.prim.sag.z = 0.3;
    assert_eq!(bench.run(LocateObj, "BLOCK", 1, "BENCH", 1), error(Reason::VisionImplausible));
    assert!(bench.memory.emove.estimates.located.is_none());
    bench.world.prim.sag.z = 0.0;
    assert_eq!(bench.run(LocateObj, "BLOCK", 1, "BENCH", 1), DONE);
}

#[test]
fn located_object_is_discarded_after_a_lost_link() {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.run(MovToVu, "BLOCK", 1, "BENCH", 1), DONE);
    assert_eq!(bench.run(LocateObj, "BLOCK", 1, "BENCH", 1), DONE);
    assert!(bench.memory.emove.estimates.located.is_some());
    (bench.world.prim.report, bench.world.prim.reason) = (PrimReport::T3LinkOff, Reason::LinkOff);
    bench.wait(3);
    assert!(bench.memory.emove.estimates.located.is_none());
}

#[test]
fn implausible_picture_moves_nothing() {
    // The picture of BLOCK is taken from 590 mm, so it ends before 11.61 in.
    const TRUTH: (i32, i32, i32, u16) = (20, -10, 1000, 17);
    for (claims, end, log) in [
        (vec![(1_162, 0, 0, 0), (0, -1_162, 0, 0), (0, 0, 9_001, 0)], error(Reason::VisionImplausible), 3),
        (vec![(i32::MIN, 0, 0, 0), TRUTH, (0, i32::MAX, 0, 17), TRUTH], DONE, 6),
        (
            vec![TRUTH, (0, 0, i32::MIN, 17), (0, 0, -9_001, 17), (0, 0, 27_000, 17)],
            error(Reason::VisionImplausible),
            5,
        ),
        (vec![TRUTH, (0, 0, 0, 18), (0, 0, 0, 0), (0, 0, 0, 18)], error(Reason::NotRecognised), 5),
        (vec![(300, -300, -9_000, 0), TRUTH], DONE, 4),
    ] {
        let mut bench = Bench::ready("HOME", 1);
        assert_eq!(bench.run(MovToVu, "BLOCK", 1, "BENCH", 1), DONE);
        bench.world.claims.clone_from(&claims);
        assert_eq!(bench.run(LocateObj, "BLOCK", 1, "BENCH", 1), end, "{claims:?}");
        assert_eq!(bench.log().len(), log, "{:?}", bench.log());
    }
}

#[test]
fn withdraw_moves_the_robot_clear() {
    let mut bench = Bench::ready("BENCH", 1);
    bench.hold("BLOCK", 75, 1);
    assert_eq!(bench.run(Withdraw, "", 0, "BENCH", 0), DONE);
    assert_eq!(bench.log(), ["DELTA-MOVE WITHDRAW"]);
    assert!(bench.off(&moved(frame_of("BENCH"), &["WITHDRAW"])) < 0.02);
    assert_eq!(bench.at(), "BENCH");
    bench.command(Withdraw, "", 0, "BENCH", 0);
    bench.wait(3);
    bench.world.grip.opening = 60;
    assert_eq!(bench.finish(), error(Reason::ObjectLost));
    let mut bench = Bench::ready("BENCH", 0);
    bench.spoil("WITHDRAW", DeliveryFault::Prim(PrimReport::Error, Reason::NotAtGoal));
    assert_eq!(bench.run(Withdraw, "", 0, "BENCH", 0), error(Reason::NotAtGoal));
    assert_eq!(bench.run(Withdraw, "", 0, "HOME", 0), error(Reason::NoRelativeMove));
}

#[test]
fn missing_data_are_reported() {
    let mut bench = Bench::ready("HOME", 1);
    assert_eq!(bench.run(MovToLoc, "", 0, "TOOL-TRNS", 0), error(Reason::NoTrajectory));
    assert_eq!(bench.run(MovToLoc, "", 0, "", 0), error(Reason::NoDestination));
    assert_eq!(bench.run(MovToObj, "BLOCK", 7, "BENCH", 1), error(Reason::UnknownGrip));
    assert_eq!(bench.run(MovToObj, "PIN", 1, "VISE", 1), error(Reason::NoApproach));
    assert_eq!(bench.run(MovToHol, "GRIPPER-1", 1, "BENCH", 1), error(Reason::NoGripMovetable));
    assert_eq!(bench.run(LocateObj, "PIN", 1, "VISE", 1), error(Reason::BadRecord));
    bench.command(MovToLoc, "", 0, "BENCH", 0);
    bench.memory.subtask.emove.pose = Some(4_000_000);
    assert_eq!(bench.finish(), error(Reason::NoDestination), "no such POSE record");
    bench.command(MovToLoc, "", 0, "BENCH", 0);
    bench.memory.subtask.emove.pose = Some(pose_range::next(pose_range::SUBTASK, 4_000_000));
    assert_eq!(bench.finish(), error(Reason::NoDestination), "no such changing record");
    assert_eq!(bench.run(interfaces::emove::EmoveVerb::None, "", 0, "", 0), error(Reason::UnknownCommand));
    bench.world.frame = moved(frame_of("HOME"), &["300ty"]);
    bench.wait(2);
    assert_eq!(bench.run(MovToLoc, "", 0, "BENCH", 0), error(Reason::UnknownStart));
    // The nearest places: HOME, three inches away, and another one.
    assert_eq!(bench.memory.emove.nearest, [None; 2], "the search is not complete");
    bench.wait(60);
    let [Some(first), Some(second)] = bench.memory.emove.nearest else { panic!("two places") };
    assert_eq!(first.location.as_str(), "HOME");
    assert!((first.inches - 3.0).abs() < 1e-9 && first.degrees.abs() < 1e-9 && second.inches > first.inches);
    bench.world.frame = frame_of("HOME");
    bench.wait(3);
    assert_eq!(bench.memory.emove.nearest, [None; 2]);
    let mut bench = Bench::ready("VISE", 0);
    let nowhere = Target::LocationPoint(LocptId::new(9_999));
    let points: Vec<_> = data().path_points.iter().map(|p| PathPoint { target: nowhere, ..*p }).collect();
    bench.data.path_points = points.leak();
    assert_eq!(bench.run(MovToLoc, "", 0, "HOME", 0), error(Reason::BadRecord), "a point of the path");
}
