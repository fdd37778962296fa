//! Commands that the processes below report as done, while the sensors contradict the goal.

use geometry::frame::Vector;
use interfaces::{
    Reason, Unconfirmed,
    emove::{
        EmoveVerb::{GraspObj, LocateObj, MovObjTo, MovToLoc, MovToObj, MovToVu, Release, Withdraw},
        Offset, Seat,
    },
};

use super::{
    bench::{Bench, DONE, error},
    doubles::DeliveryFault,
};

#[test]
fn unmoved_robot_does_not_complete_the_motion() {
    let mut bench = Bench::ready("HOME", 1);
    bench.spoil("GOTO-PT", DeliveryFault::Stays);
    assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), error(Reason::NotAtGoal));
    assert_eq!(bench.memory.emove.status.at, None);
}

#[test]
fn arm_off_the_goal_does_not_complete_the_motion() {
    for (sag, end, offset) in [
        (0.01, DONE, Offset::None),
        (0.04, DONE, Offset::Slight),
        (0.10, error(Reason::NotAtGoal), Offset::None),
    ] {
        let mut bench = Bench::ready("HOME", 1);
        bench.world.prim.sag = Vector::new(0.0, 0.0, sag);
        assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), end, "{sag} in");
        assert_eq!(bench.memory.emove.status.offset, offset, "{sag} in");
    }
}

#[test]
fn arm_off_the_commanded_pose_does_not_complete_the_withdrawal() {
    let mut bench = Bench::ready("BENCH", 1);
    bench.world.prim.sag = Vector::new(0.0, 0.1, 0.0);
    assert_eq!(bench.run(Withdraw, "", 0, "BENCH", 0), error(Reason::NotAtGoal));
}

#[test]
fn only_the_parts_gripper_confirms_the_grasp_force() {
    for (gripper, object, size, unconfirmed) in [
        (1, "BLOCK", 75, Unconfirmed::None),
        (2, "SHAFT", 204, Unconfirmed::GraspForce),
        (3, "CUTTER", 246, Unconfirmed::GraspForce),
    ] {
        let mut bench = Bench::ready("HOME", gripper);
        bench.world.object = Some(size);
        assert_eq!(bench.run(GraspObj, object, 1, "HOME", gripper), DONE);
        assert_eq!(bench.memory.emove.status.unconfirmed, unconfirmed, "{object}");
        assert_eq!(bench.run(MovObjTo, object, 1, "VISE", gripper), DONE);
        assert_eq!(bench.memory.emove.status.unconfirmed, unconfirmed, "{object}");
        assert_eq!(bench.run(Release, object, 1, "VISE", gripper), DONE);
        assert_eq!(bench.memory.emove.status.unconfirmed, Unconfirmed::None, "{object}");
    }
}

/// The operator moves the robot with a held part. Then the robot grasps it again, brings it to the vise and fetches
/// it.
#[test]
fn part_held_during_manual_motion_has_an_unconfirmed_seat() {
    for (gripper, object, size, sensed) in
        [(1, "BLOCK", 75, Unconfirmed::None), (2, "SHAFT", 204, Unconfirmed::GraspForce)]
    {
        let mut bench = Bench::ready("HOME", gripper);
        bench.world.object = Some(size);
        assert_eq!(bench.run(GraspObj, object, 1, "HOME", gripper), DONE);
        assert_eq!(bench.memory.emove.status.unconfirmed, sensed, "{object}");
        bench.lead(|_| {});
        bench.pause();
        assert_eq!(bench.memory.emove.status.seat, Seat::NotKnown, "{object}");
        for (verb, location) in [(GraspObj, "HOME"), (MovObjTo, "VISE")] {
            assert_eq!(bench.run(verb, object, 1, location, gripper), DONE, "{object} {verb}");
            assert_eq!(bench.memory.emove.status.unconfirmed, Unconfirmed::PartInFingers, "{object} {verb}");
        }
        assert_eq!(bench.run(Release, object, 1, "VISE", gripper), DONE);
        assert_eq!(bench.memory.emove.status.seat, Seat::NotKnown, "seat of the placed object");
        bench.world.object = Some(size);
        assert_eq!(bench.run(GraspObj, object, 1, "VISE", gripper), DONE);
        assert_eq!(
            bench.memory.emove.status.unconfirmed,
            Unconfirmed::PartInFingers,
            "the regrasped object keeps its seat"
        );
    }
}

#[test]
fn picture_locates_a_part_released_with_an_unconfirmed_seat() {
    let mut bench = Bench::ready("BENCH", 1);
    bench.world.object = Some(75);
    assert_eq!(bench.run(GraspObj, "BLOCK", 1, "BENCH", 1), DONE);
    bench.lead(|_| {});
    bench.pause();
    for verb in [Release, MovToVu, LocateObj, MovToObj] {
        assert_eq!(bench.run(verb, "BLOCK", 1, "BENCH", 1), DONE, "{verb}");
        assert_eq!(bench.memory.emove.status.seat, Seat::NotKnown, "{verb}");
    }
    bench.world.object = Some(75);
    assert_eq!(bench.run(GraspObj, "BLOCK", 1, "BENCH", 1), DONE);
    assert_eq!(bench.memory.emove.status.unconfirmed, Unconfirmed::None);
}

/// Prim keeps `done` of its last command while the arm sinks.
#[test]
fn part_held_by_an_arm_without_pressure_has_an_unconfirmed_seat() {
    for is_closing in [false, true] {
        let mut bench = Bench::ready("BENCH", 1);
        bench.world.object = Some(75);
        if !is_closing {
            assert_eq!(bench.run(GraspObj, "BLOCK", 1, "BENCH", 1), DONE);
        }
        bench.world.prim.controller_off = true;
        bench.wait(3);
        assert_eq!(bench.run(GraspObj, "BLOCK", 1, "BENCH", 1), DONE);
        assert_eq!(
            bench.memory.emove.status.unconfirmed,
            Unconfirmed::PartInFingers,
            "closing: {is_closing}"
        );
    }
}

#[test]
fn released_part_near_an_arm_without_pressure_has_an_unconfirmed_place() {
    let mut bench = Bench::ready("VISE", 1);
    bench.hold("BLOCK", 75, 1);
    assert_eq!(bench.run(Release, "BLOCK", 1, "VISE", 1), DONE);
    assert_eq!(bench.memory.emove.status.seat, Seat::Kept);
    let mut clear = bench.clone();
    assert_eq!(clear.run(MovToLoc, "", 0, "HOME", 0), DONE);
    for (bench, seat) in [(&mut bench, Seat::NotKnown), (&mut clear, Seat::Kept)] {
        bench.world.prim.controller_off = true;
        bench.wait(3);
        assert_eq!(bench.memory.emove.status.seat, seat);
    }
}

/// No picture is taken in the vise. The operator moves the robot near the object before the grasp, or far from it. A
/// released object keeps its unconfirmed seat.
#[test]
fn part_near_manual_motion_of_the_empty_robot_has_an_unconfirmed_seat() {
    for (led_at, fetched_at, unconfirmed) in [
        ("VISE", "VISE", Unconfirmed::PartInFingers),
        ("VISE", "BENCH", Unconfirmed::None),
        ("HOME", "VISE", Unconfirmed::None),
    ] {
        let mut bench = Bench::ready("HOME", 1);
        assert_eq!(bench.run(MovToObj, "BLOCK", 1, led_at, 1), DONE, "{led_at}");
        bench.pause();
        bench.lead(|_| {});
        bench.pause();
        for at in [fetched_at, "BENCH", fetched_at] {
            let expected = if at == fetched_at { unconfirmed } else { Unconfirmed::None };
            assert_eq!(bench.run(MovToObj, "BLOCK", 1, at, 1), DONE, "{led_at} {at}");
            bench.world.object = Some(75);
            assert_eq!(bench.run(GraspObj, "BLOCK", 1, at, 1), DONE, "{led_at} {at}");
            assert_eq!(bench.memory.emove.status.unconfirmed, expected, "{led_at} {at}");
            assert_eq!(bench.run(Release, "BLOCK", 1, at, 1), DONE, "{led_at} {at}");
        }
    }
}

#[test]
fn manual_motion_with_empty_fingers_keeps_the_seat() {
    let mut bench = Bench::ready("HOME", 1);
    bench.lead(|_| {});
    bench.pause();
    assert_eq!(bench.memory.emove.status.seat, Seat::Kept);
}
