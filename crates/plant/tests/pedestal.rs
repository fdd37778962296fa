//! The Active Pedestal: its grip, its rotation, and the handover of a part.

use crate::rig::{PED, Rig, description, table};
use geometry::{
    frame::{Frame, Vector, rotation_from_x_y, rotation_vector},
    movetable::System,
};
use interfaces::device::{MotorOrder, TABLE_STEPS_PER_TENTH, valve};
use plant::{CellEvent, WorkstationAction};

/// The pedestal's frame: X away from the robot, Y left, Z up.
fn pedestal() -> Frame {
    PED.to_frame().unwrap()
}

fn with_clevis() -> Rig {
    let mut rig = Rig::new(&description(), 1);
    rig.table_square();
    rig.pedestal_open(4.0);
    let upright = rotation_from_x_y(&Vector::x(), &Vector::y()).unwrap();
    let frame = Frame { position: Vector::new(0.0, 0.1, -0.998), rotation: upright };
    let frame = pedestal().compose(&frame);
    rig.cell.workstation(&WorkstationAction::Put { part: "LCLEVIS_IH".into(), frame }).unwrap();
    rig.ticks(10);
    rig
}

fn at_part(back: f64, up: f64) -> Frame {
    let frame = table(&[(System::Tool, [64, 0, 100])]).apply(&pedestal());
    let frame = frame.shifted(Vector::new(-back, 0.0, 0.0));
    Frame { position: frame.position + Vector::new(0.0, 0.0, up), ..frame }
}

fn come(rig: &mut Rig) {
    rig.go(at_part(15.0, 6.0), 10.0);
    rig.open(3.5);
    rig.go(at_part(10.0, 0.0), 10.0);
    rig.go_and_stop(at_part(0.0, 0.0), 4.0);
}

fn leave(rig: &mut Rig) {
    rig.open(3.5);
    rig.go(at_part(10.0, 0.0), 4.0);
    rig.go(at_part(15.0, 6.0), 10.0);
}

fn part(rig: &Rig) -> Frame {
    pedestal().inverse().compose(&rig.part_frame())
}

#[test]
fn pedestal_fingers_move_across_the_radial_line_at_2135() {
    let mut rig = Rig::new(&description(), 1);
    rig.table_square();
    assert_eq!(rig.inputs.pedestal.motor_counter, -2_135 * TABLE_STEPS_PER_TENTH);
    let hand = pedestal().inverse().compose(&rig.cell.pedestal());
    assert!(hand.position.norm() < 0.01, "the pose is a table's, in hundredths: {:?}", hand.position);
    assert!((hand.x() - Vector::z()).norm() < 1e-3, "it points up: {:?}", hand.x());
    assert!((hand.y().y.abs() - 1.0).abs() < 1e-6, "across the radial line: {:?}", hand.y());
    rig.table(MotorOrder::Turn, 1_835 * TABLE_STEPS_PER_TENTH);
    let flipped = pedestal().inverse().compose(&rig.cell.pedestal());
    assert!((flipped.y() + hand.y()).norm() < 1e-3, "turned by 180 degrees: {:?}", flipped.y());
}

#[test]
fn sensors_measure_opening_force_angle_and_limits() {
    let mut rig = Rig::new(&description(), 1);
    rig.table(MotorOrder::Turn, 100_000);
    let there = rig.inputs.pedestal;
    assert!(there.limit_plus && !there.limit_minus);
    rig.table(MotorOrder::Turn, -100_000);
    let back = rig.inputs.pedestal;
    assert!(back.limit_minus && !back.limit_plus);
    // 345 degrees of the motor are 338.4 of the table, 10 counts each.
    let turned = f64::from(there.table_potentiometer) - f64::from(back.table_potentiometer);
    assert!((turned - 3450.0 * 180.0 / 183.5).abs() < 3.0, "{turned}");
    rig.pedestal_open(4.0);
    let open = rig.inputs.pedestal.potentiometer;
    assert!((f64::from(open) - 198.0 - 705.0 * rig.cell.pedestal_fingers().0).abs() < 2.0, "{open}");
}

#[test]
fn pedestal_hand_holds_and_turns_a_part() {
    let mut rig = with_clevis();
    let free = rig.inputs.pedestal;
    rig.pedestal_close(50.0);
    assert_eq!(rig.part().location, "PEDESTAL");
    let held = rig.inputs.pedestal;
    assert!(held.strain_left > free.strain_left + 1900 && held.strain_right > free.strain_right + 1900);
    assert!((rig.cell.pedestal_fingers().0 - 2.56).abs() < 0.001, "{:?}", rig.cell.pedestal_fingers());
    rig.ticks(20);
    let before = part(&rig);
    assert!(before.position.y.abs() < 0.002, "drawn to the middle: {:?}", before.position);
    rig.ticks(500);
    rig.table(MotorOrder::Turn, 18_350);
    rig.ticks(20);
    let after = part(&rig);
    assert!((after.x() + before.x()).norm() < 2e-3 && (after.z() - before.z()).norm() < 2e-3, "{after:?}");
    let moved = (after.position - before.position).norm();
    assert!(moved < 0.05, "its middle is on the axis and stays: {moved}");
    assert!(rig.log.is_empty(), "{:?}", rig.log);
    rig.pedestal_open(4.0);
    rig.ticks(30);
    assert!((part(&rig).position.z + 1.0).abs() < 0.01, "it stands on the palm: {:?}", part(&rig));
}

#[test]
fn part_is_regripped_from_the_other_side() {
    let mut rig = with_clevis();
    rig.pedestal_close(50.0);
    come(&mut rig);
    rig.close(50.0);
    let both = part(&rig);
    assert!(rig.part().held && rig.part().location == "gripper", "{:?}", rig.part());
    rig.pedestal_open(4.5);
    rig.ticks(20);
    assert!(rig.part().held, "{:?} {:?}", rig.part(), rig.log);
    assert!((part(&rig).position - both.position).norm() < 0.03, "{:?} {:?}", part(&rig), both);
    // Up and back: only the robot holds it.
    rig.go_and_stop(at_part(0.0, 2.0), 2.0);
    assert!((part(&rig).position.z - both.position.z - 2.0).abs() < 0.03, "{:?}", part(&rig));
    rig.go_and_stop(at_part(0.0, 0.02), 2.0);
    rig.pedestal_close(50.0);
    leave(&mut rig);
    assert_eq!(rig.part().location, "PEDESTAL", "{:?}", rig.log);
    let before = part(&rig);
    rig.table(MotorOrder::Turn, 18_350);
    come(&mut rig);
    rig.close(40.0);
    rig.pedestal_open(4.5);
    rig.go_and_stop(at_part(0.0, 4.0), 4.0);
    let after = part(&rig);
    assert!(rig.part().held && rig.part().location == "gripper", "{:?} {:?}", rig.part(), rig.log);
    let turned = rotation_vector(&(before.rotation.inverse() * after.rotation)).norm();
    assert!((turned - core::f64::consts::PI).abs() < 0.01, "flipped by {} degrees", turned.to_degrees());
    assert!(after.position.x.abs() < 0.05 && after.position.y.abs() < 0.05, "{after:?}");
    let mishaps: Vec<_> =
        rig.log.iter().filter(|event| !matches!(event, CellEvent::Slipped { .. })).collect();
    assert!(mishaps.is_empty(), "{mishaps:?}");
}

#[test]
fn hand_grips_a_tilted_part_without_a_jolt() {
    let mut rig = with_clevis();
    rig.pedestal_close(50.0);
    rig.go(at_part(15.0, 6.0), 10.0);
    rig.open(3.5);
    rig.go(at_part(10.0, 0.0), 10.0);
    // 0.06 in to the left of the part: too far for the arm's springs to draw it to the middle without an event.
    let beside = |back: f64| {
        let frame = at_part(back, 0.0);
        Frame { position: frame.position + pedestal().y() * 0.06, ..frame }
    };
    rig.go_and_stop(beside(0.0), 4.0);
    let before = part(&rig).position;
    rig.close(50.0);
    rig.ticks(50);
    assert!((part(&rig).position - before).norm() < 0.01, "{before:?} {:?}", part(&rig));
    rig.pedestal_open(4.5);
    rig.ticks(30);
    let drawn = (part(&rig).position - before).y;
    assert!((drawn - 0.06).abs() < 0.02, "now the robot has it in the middle of its fingers: {drawn}");
    assert!(!rig.log.contains(&CellEvent::Quarantined), "{:?}", rig.log);
}

#[test]
fn part_slides_between_two_pulling_hands() {
    let mut rig = with_clevis();
    rig.pedestal_close(8.0);
    come(&mut rig);
    rig.close(60.0);
    rig.go_and_stop(at_part(4.0, 0.0), 2.0);
    let out = part(&rig);
    assert!(out.position.x < -1.0, "the stronger hand has it: {out:?} {:?}", rig.log);
    let slid = rig.log.iter().any(|event| {
        matches!(event, CellEvent::Slipped { hand, .. } | CellEvent::Dropped { hand, .. } if *hand == "the pedestal's hand")
    });
    assert!(slid, "{:?}", rig.log);
    assert!(!rig.log.contains(&CellEvent::Quarantined), "{:?}", rig.log);
    rig.ticks(100);
    let still = part(&rig);
    rig.ticks(25);
    assert!((part(&rig).position - still.position).norm() < 0.01, "at rest: {still:?} {:?}", part(&rig));
}

#[test]
fn part_without_a_holder_falls() {
    let mut rig = with_clevis();
    rig.pedestal_close(50.0);
    come(&mut rig);
    rig.close(50.0);
    rig.pedestal_open(4.5);
    rig.go_and_stop(at_part(8.0, 3.0), 4.0);
    assert!(rig.part().held);
    rig.outputs.grip.bits = valve::SUPPLY | valve::VENT;
    rig.ticks(100);
    assert!(!rig.part().held && part(&rig).position.z < -3.0, "{:?}", part(&rig));
}

#[test]
fn collision_of_the_robot_with_the_hand_is_reported() {
    let mut rig = Rig::new(&description(), 1);
    rig.table_square();
    rig.go(at_part(10.0, 0.0), 10.0);
    rig.go_and_stop(at_part(0.0, -1.5), 4.0);
    let met = rig.log.iter().any(
        |event| matches!(event, CellEvent::Contact(contact) if contact.obstacle.starts_with("pedestal_")),
    );
    assert!(met, "{:?}", rig.log);
}
