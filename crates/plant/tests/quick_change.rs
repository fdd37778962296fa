//! Detaching and attaching grippers at their holsters, with arm and valves driven directly.

use crate::rig::{Rig, description};
use geometry::{
    frame::{Frame, Vector, rotation_by},
    pose::Pose,
};
use interfaces::device::{GripValves, HolsterSensors, JawValves, QuickChangeValves, valve};
use plant::CellEvent;

const HOL_V1: Pose =
    Pose { wrist: [152, -4372, 2619], tool: [188, -5397, -200], finger: [3186, -5292, -200] };
const HOL_R: Pose =
    Pose { wrist: [-1188, -3176, -407], tool: [-1261, -3372, -3400], finger: [1549, -4423, -3400] };
const HOL_L: Pose =
    Pose { wrist: [2598, -2179, -407], tool: [2758, -2314, -3400], finger: [4686, -16, -3400] };
const HOL_C: Pose =
    Pose { wrist: [1867, -4194, -407], tool: [1952, -4385, -3400], finger: [4693, -3165, -3400] };

const LOCK: QuickChangeValves = QuickChangeValves { lock: true, unlock: false, port: true };
const UNLOCK: QuickChangeValves = QuickChangeValves { lock: false, unlock: true, port: true };
const FULL: u8 = 0x0F;

fn over(holster: &Pose, up: f64, forward: f64) -> Frame {
    holster.to_frame().unwrap().shifted(Vector::new(-up, 0.0, forward))
}

fn air(rig: &mut Rig, valves: QuickChangeValves) {
    rig.outputs.quick_change = valves;
    rig.ticks(12);
    rig.outputs.quick_change = QuickChangeValves::default();
    rig.tick();
}

/// A rig with the parts gripper over its holster, its ears `up` above it.
fn over_right(up: f64) -> Rig {
    let mut rig = Rig::new(&description(), 1);
    rig.go(HOL_V1.to_frame().unwrap(), 10.0);
    rig.go(over(&HOL_R, 14.0, 0.0), 10.0);
    rig.go_and_stop(over(&HOL_R, 1.0, 0.0), 10.0);
    assert_eq!(rig.inputs.holsters.right, 0, "the ears are too high for the large sensors");
    rig.go_and_stop(over(&HOL_R, up, 0.0), 1.0);
    rig
}

/// QC-DETACH at the right holster, from above it to clear above it.
fn detach() -> Rig {
    let mut rig = over_right(0.35);
    air(&mut rig, UNLOCK);
    rig.go_and_stop(over(&HOL_R, 0.35, 1.46), 1.0);
    rig.go_and_stop(over(&HOL_R, 14.0, 1.46), 4.0);
    rig
}

/// QC-ATTACH at a holster, from clear above it.
fn attach(rig: &mut Rig, holster: &Pose) {
    rig.go(over(holster, 14.0, 1.5), 10.0);
    rig.go(over(holster, 1.0, 1.5), 5.0);
    rig.go_and_stop(over(holster, 0.0, 1.5), 0.5);
    air(rig, LOCK);
    rig.go_and_stop(over(holster, 0.0, 0.0), 1.0);
    rig.go_and_stop(over(holster, 2.0, 0.0), 2.0);
}

#[test]
fn parts_gripper_is_on_the_robot_at_the_start() {
    let rig = Rig::new(&description(), 1);
    let quick_change = rig.inputs.quick_change;
    assert_eq!(quick_change.end_effector_id, 1);
    assert!(quick_change.locked && !quick_change.unlocked);
    assert_eq!(rig.inputs.holsters, HolsterSensors { right: 0, left: FULL, centre: FULL });
    assert_eq!(rig.cell.gripper(), Some(1));
}

#[test]
fn detached_gripper_stays_in_its_seat() {
    let mut rig = over_right(0.35);
    assert_eq!(rig.inputs.holsters.right, 0b0011, "the large sensors see the ears");
    rig.outputs.quick_change = UNLOCK;
    rig.ticks(4);
    let between = rig.inputs.quick_change;
    assert!(!between.locked && !between.unlocked && between.end_effector_id == 1, "{between:?}");
    rig.ticks(8);
    let dropped = rig.inputs.quick_change;
    assert!(dropped.unlocked && dropped.end_effector_id == 1, "the pins still touch: {dropped:?}");
    assert_eq!(rig.cell.gripper(), None);
    rig.outputs.quick_change = QuickChangeValves::default();
    rig.go_and_stop(over(&HOL_R, 0.35, 1.30), 1.0);
    assert_eq!(rig.inputs.holsters.right, 0b0011, "0.20 before the seat");
    rig.go_and_stop(over(&HOL_R, 0.35, 1.46), 1.0);
    assert_eq!(rig.inputs.holsters.right, FULL, "the gripper slides with the robot into the seat");
    assert_eq!(rig.inputs.quick_change.end_effector_id, 1);
    rig.go_and_stop(over(&HOL_R, 14.0, 1.46), 4.0);
    assert_eq!((rig.inputs.quick_change.end_effector_id, rig.inputs.holsters.right), (0, FULL));
    assert_eq!(
        (rig.inputs.grip.potentiometer, rig.inputs.grip.strain_left),
        (0, 0),
        "no sensor is connected"
    );
    assert_eq!(rig.log, [], "and no contact occurred");
    let seat = over(&HOL_R, 0.0, 1.5);
    let hangs = rig.cell.links().into_iter().find(|link| link.name == "parts_gripper").unwrap();
    let at = Vector::from(hangs.position) / 0.0254;
    assert!((at - seat.position).norm() < 0.02, "{at:?}");
}

#[test]
fn every_gripper_can_be_attached_and_used() {
    let mut rig = detach();
    for (holster, id) in [(HOL_L, 2), (HOL_C, 3), (HOL_R, 1)] {
        attach(&mut rig, &holster);
        let quick_change = rig.inputs.quick_change;
        assert_eq!((quick_change.end_effector_id, quick_change.locked), (id, true), "{:?}", rig.log);
        assert_eq!(rig.cell.gripper(), Some(id));
        let open = JawValves { open: true, close: false };
        match id {
            1 => rig.outputs.grip = GripValves { bits: valve::SUPPLY | valve::OPEN_MEDIUM },
            2 => rig.outputs.v_grip = open,
            _ => rig.outputs.tool_grip = open,
        }
        rig.ticks(150);
        let (opening, counts) = [(5.0, 3705), (3.5, 2305), (4.0, 2605)][usize::from(id) - 1];
        assert!((rig.cell.fingers().0 - opening).abs() < 1e-9, "{id}: {:?}", rig.cell.fingers());
        assert!(rig.inputs.grip.potentiometer.abs_diff(counts) <= 1, "{id}: {:?}", rig.inputs.grip);
        assert_eq!(rig.inputs.force.valid, id == 3);
        assert_eq!(rig.inputs.grip.strain_left > 0, id == 1, "only the parts gripper has strain gages");
        (rig.outputs.v_grip, rig.outputs.tool_grip) = Default::default();
        rig.outputs.grip.bits = 0;
        rig.go_and_stop(over(&holster, 0.3, 0.0), 2.0);
        air(&mut rig, UNLOCK);
        rig.go_and_stop(over(&holster, 0.3, 1.5), 1.0);
        rig.go_and_stop(over(&holster, 14.0, 1.5), 4.0);
        assert_eq!(rig.inputs.quick_change.end_effector_id, 0, "{id}");
    }
    assert_eq!(rig.inputs.holsters, HolsterSensors { right: FULL, left: FULL, centre: FULL });
    assert_eq!(rig.log, []);
}

#[test]
fn plate_above_its_seat_is_not_locked() {
    for (what, up, forward, roll, pins) in [
        ("too high", 0.10, 1.5, 0.0_f64, 2),
        ("too far back", 0.0, 1.42, 0.0, 2),
        ("turned", 0.0, 1.5, 1.5, 2),
        ("beside it", 0.0, 1.2, 0.0, 0),
    ] {
        let mut rig = detach();
        let turn = rotation_by(&Vector::new(roll.to_radians(), 0.0, 0.0));
        rig.go(over(&HOL_L, 14.0, 1.5), 10.0);
        rig.go_and_stop(over(&HOL_L, up, forward).turned(&turn), 4.0);
        air(&mut rig, LOCK);
        let quick_change = rig.inputs.quick_change;
        assert!(quick_change.locked && quick_change.end_effector_id == pins, "{what}: {quick_change:?}");
        assert_eq!(rig.cell.gripper(), None, "{what}");
        rig.go_and_stop(over(&HOL_L, 3.0, 1.5), 2.0);
        assert_eq!((rig.inputs.quick_change.end_effector_id, rig.inputs.holsters.left), (0, FULL), "{what}");
    }
}

#[test]
fn ring_locked_too_early_catches_no_gripper() {
    let mut rig = detach();
    air(&mut rig, LOCK);
    rig.go(over(&HOL_L, 14.0, 1.5), 10.0);
    rig.go_and_stop(over(&HOL_L, 0.0, 1.5), 2.0);
    air(&mut rig, LOCK);
    assert_eq!(rig.cell.gripper(), None);
}

#[test]
fn ring_does_not_move_without_the_port() {
    let mut rig = over_right(0.35);
    air(&mut rig, QuickChangeValves { port: false, ..UNLOCK });
    assert!(rig.inputs.quick_change.locked);
    rig.go_and_stop(over(&HOL_R, 5.0, 0.0), 4.0);
    assert_eq!(rig.cell.gripper(), Some(1), "it is still on");
    assert_eq!(rig.inputs.holsters.right, 0);
}

#[test]
fn gripper_unlocked_in_the_air_falls_to_the_floor() {
    for up in [0.7, 5.0] {
        let mut rig = over_right(up);
        air(&mut rig, UNLOCK);
        rig.ticks(50);
        assert_eq!(rig.log[0], CellEvent::GripperFell { gripper: "parts_gripper".into() }, "{up}");
        assert_eq!(rig.inputs.quick_change.end_effector_id, 0);
        let fallen = rig.cell.links().into_iter().find(|link| link.name == "parts_gripper").unwrap();
        let height = fallen.position[2] / 0.0254;
        assert!(height < over(&HOL_R, up, 0.0).position.z - 0.3 && height > -50.5, "{up}: {height}");
    }
}

#[test]
fn gripper_released_over_a_full_holster_falls() {
    let mut rig = Rig::new(&description(), 1);
    rig.go(HOL_V1.to_frame().unwrap(), 10.0);
    rig.go_and_stop(over(&HOL_L, 5.0, 0.0), 10.0);
    rig.go_and_stop(over(&HOL_L, 0.4, 0.0), 10.0);
    air(&mut rig, UNLOCK);
    assert!(rig.log.contains(&CellEvent::GripperFell { gripper: "parts_gripper".into() }), "{:?}", rig.log);
    assert!(
        rig.log
            .iter()
            .any(|event| matches!(event, CellEvent::Contact(contact) if contact.obstacle == "v_gripper")),
        "{:?}",
        rig.log
    );
}

#[test]
fn lifting_out_of_the_seat_detaches_the_gripper() {
    let mut rig = detach();
    rig.go(over(&HOL_L, 14.0, 1.5), 10.0);
    rig.go_and_stop(over(&HOL_L, 0.0, 1.5), 2.0);
    air(&mut rig, LOCK);
    assert_eq!(rig.cell.gripper(), Some(2));
    rig.go_and_stop(over(&HOL_L, 2.0, 1.5), 1.0);
    assert!(rig.log.contains(&CellEvent::GripperTorn { gripper: "v_gripper".into() }), "{:?}", rig.log);
    assert_eq!((rig.cell.gripper(), rig.inputs.quick_change.end_effector_id), (None, 0));
    assert_eq!(rig.inputs.holsters.left, FULL, "the holster keeps it");
}

#[test]
fn early_lift_leaves_the_gripper_before_its_seat() {
    let mut rig = over_right(0.35);
    air(&mut rig, UNLOCK);
    rig.go_and_stop(over(&HOL_R, 0.35, 0.8), 1.0);
    rig.go_and_stop(over(&HOL_R, 3.0, 0.8), 2.0);
    assert_eq!((rig.inputs.quick_change.end_effector_id, rig.inputs.holsters.right), (0, 0b0011));
}

#[test]
fn part_is_lost_when_the_air_is_cut() {
    let mut rig = Rig::new(&description(), 1);
    rig.place("LINKBAR1_BH", 4, 0.0, 0.0, 0.0);
    rig.pick(0.0, 0.0, 0.0, 30.0);
    assert!(rig.part().held);
    air(&mut rig, UNLOCK);
    rig.ticks(30);
    assert!(!rig.part().held);
    assert!(rig.log.iter().any(|event| matches!(event, CellEvent::Dropped { .. })), "{:?}", rig.log);
}

/// A person takes the v-gripper, which is not on the robot, out of its holster, and places it in a holster.
#[test]
fn only_a_detached_gripper_fits_an_empty_holster() {
    let mut rig = Rig::new(&description(), 1);
    assert_eq!(rig.inputs.holsters.left, FULL);
    rig.cell.hang_gripper(2, None).unwrap();
    rig.tick();
    assert_eq!(rig.inputs.holsters.left, 0);
    assert!(!rig.cell.is_holstered(2));
    let on_the_robot = rig.cell.hang_gripper(1, Some(0)).unwrap_err().to_string();
    let occupied = rig.cell.hang_gripper(2, Some(2)).unwrap_err().to_string();
    let (no_gripper, no_holster) = (rig.cell.hang_gripper(4, None), rig.cell.hang_gripper(2, Some(3)));
    assert!(on_the_robot.contains("parts_gripper"), "{on_the_robot}");
    assert!(occupied.contains("tool_gripper is in the way"), "{occupied}");
    assert!(no_gripper.is_err() && no_holster.is_err());
    for (which, full) in [(0, [FULL, 0]), (1, [0, FULL])] {
        rig.cell.hang_gripper(2, Some(which)).unwrap();
        rig.tick();
        assert_eq!([rig.inputs.holsters.right, rig.inputs.holsters.left], full);
    }
    assert!(rig.cell.is_holstered(2));
}
