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
    doubles::Mishap,
};

#[test]
fn motion_is_not_done_if_the_robot_has_not_moved() {
    let mut bench = Bench::ready("HOME", 1);
    bench.spoil("GOTO-PT", Mishap::Stays);
    assert_eq!(bench.run(MovToLoc, "", 0, "VISE", 0), error(Reason::NotAtGoal));
    assert_eq!(bench.memory.emove.status.at, None);
}

#[test]
fn motion_is_not_done_if_the_arm_hangs_beside_the_goal() {
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
fn withdrawal_is_not_done_if_the_arm_hangs_beside_the_commanded_pose() {
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

/// The seat of an object on which the fingers have closed, when a person has led the robot since, and the robot grasps it
/// again, brings it to the vise and fetches it again.
#[test]
fn part_with_which_a_person_has_led_the_robot_has_no_confirmed_place_in_the_fingers() {
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
        assert_eq!(bench.memory.emove.status.seat, Seat::NotKnown, "as it was placed");
        bench.world.object = Some(size);
        assert_eq!(bench.run(GraspObj, object, 1, "VISE", gripper), DONE);
        assert_eq!(
            bench.memory.emove.status.unconfirmed,
            Unconfirmed::PartInFingers,
            "it lies as it was held"
        );
    }
}

#[test]
fn picture_shows_where_a_part_is_that_was_let_go_with_an_unknown_place_in_the_fingers() {
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

/// Prim keeps `done` of its last command while the arm sinks: nothing was commanded since.
#[test]
fn part_in_the_fingers_of_an_arm_without_pressure_has_no_confirmed_place() {
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
fn part_that_was_just_released_may_be_pushed_by_an_arm_without_pressure() {
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

/// No picture is taken in the vise. A person leads the robot beside the object before it is grasped, or far from it. An
/// object that is let go with an unknown place in the fingers keeps it.
#[test]
fn part_beside_which_a_person_has_led_the_empty_robot_has_no_confirmed_place_in_the_fingers() {
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
fn empty_fingers_have_nothing_that_slides() {
    let mut bench = Bench::ready("HOME", 1);
    bench.lead(|_| {});
    bench.pause();
    assert_eq!(bench.memory.emove.status.seat, Seat::Kept);
}
