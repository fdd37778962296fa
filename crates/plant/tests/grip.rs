//! Limits of a grip.

use crate::rig::{self, Rig, UNIT_V1, description, table};
use geometry::frame::{Vector, rotation_vector};
use interfaces::device::valve;
use plant::{CellEvent, Placement, WorkstationAction};

fn in_fingers(rig: &Rig) -> Vector {
    rig.cell.tool().inverse().compose(&rig.part_frame()).position
}

#[test]
fn closing_fingers_centre_and_align_a_part() {
    let mut rig = Rig::new(&description(), 1);
    rig.place("LINKBAR1_BH", 4, 0.0, 0.4, 3.0);
    rig.pick(0.0, 0.0, 0.0, 30.0);
    let held = rig.cell.tool().inverse().compose(&rig.part_frame());
    assert!(rig.part().held && held.position.y.abs() < 0.001, "{held:?}");
    let across = rotation_vector(&held.rotation);
    assert!(across.x.abs() < 0.001 && across.z.abs() < 0.001, "flush with the pads: {across:?}");
    assert!((rig.cell.fingers().0 - 0.625).abs() < 0.001, "{:?}", rig.cell.fingers());
}

#[test]
fn held_part_does_not_creep() {
    let mut rig = Rig::new(&description(), 1);
    rig.place("LINKBAR1_BH", 4, 0.0, 0.0, 0.0);
    rig.pick(0.0, 0.0, 0.0, 30.0);
    rig.ticks(30);
    let before = in_fingers(&rig);
    rig.ticks(1500);
    let creep = (in_fingers(&rig) - before).norm();
    assert!(creep < 0.004, "{creep} in a minute");
    assert!(rig.log.is_empty(), "{:?}", rig.log);
}

fn with_block(weight: f64) -> plant::CellDescription {
    let text = format!(
        "{}\n[[part]]\nname = \"BLOCK\"\nsize = [2.0, 2.0, 2.0]\nweight = {weight}\nvision_id = 99\n",
        rig::CELL
    );
    plant::CellDescription::from_toml(&text).unwrap()
}

/// Close on a block in sector 4 with `force` lb and lift by 5 in.
fn lift_block(weight: f64, force: f64) -> Rig {
    let mut rig = Rig::new(&with_block(weight), 1);
    rig.place("BLOCK", 4, 0.0, 0.0, 0.0);
    let sector = description().tray("UNIT_1").unwrap().sector(4).unwrap();
    let grip = table(&[
        (geometry::movetable::System::Tool, [-60, 0, 0]),
        (geometry::movetable::System::ToolOrigin, [-300, 0, 0]),
    ])
    .apply(&sector);
    rig.go(UNIT_V1.to_frame().unwrap(), 10.0);
    rig.open(3.0);
    rig.go(grip.shifted(Vector::new(-8.0, 0.0, 0.0)), 10.0);
    rig.go_and_stop(grip, 4.0);
    rig.close(force);
    rig.go_and_stop(grip.shifted(Vector::new(-5.0, 0.0, 0.0)), 2.0);
    rig
}

#[test]
fn friction_limits_the_lifted_weight() {
    // Two pads of 30 lb at 0.30 carry 18 lb.
    let rig = lift_block(15.0, 30.0);
    assert!(rig.part().held && rig.part().position[2] > -12.5, "{:?} {:?}", rig.part(), rig.log);
    assert!(rig.log.is_empty(), "{:?}", rig.log);

    let rig = lift_block(24.0, 30.0);
    assert!(rig.part().position[2] < -15.0, "it stays in the tray: {:?}", rig.part());
    assert!(
        matches!(rig.log.as_slice(), [CellEvent::Slipped { .. }, CellEvent::Dropped { .. }]),
        "{:?}",
        rig.log
    );

    let rig = lift_block(24.0, 50.0);
    assert!(rig.part().held && rig.part().position[2] > -12.5, "50 lb carry 30: {:?}", rig.part());
}

#[test]
fn bar_gripped_softly_at_its_end_droops() {
    // 0.44 lb at 1.67 in from the pads needs 0.73 in.lb; two pads of 4 lb give 0.48 in.lb, of 30 lb 3.6.
    for (force, droops) in [(4.0, true), (30.0, false)] {
        let mut rig = Rig::new(&description(), 1);
        rig.place("LINKBAR1_BH", 4, 0.0, 0.0, 0.0);
        rig.pick(0.0, 0.0, 0.0, force);
        rig.ticks(50);
        let along = rig.part_frame().z();
        assert_eq!(
            along.z.abs() > 0.3,
            droops,
            "{force} lb: the bar lies along {along:?}, {:?} {:?}",
            rig.part(),
            rig.log
        );
        assert!(rig.part().held, "{:?}", rig.part());
    }
}

#[test]
fn vented_fingers_release_their_part() {
    let mut rig = Rig::new(&description(), 1);
    rig.place("LINKBAR1_BH", 4, 0.0, 0.0, 0.0);
    rig.pick(0.0, 0.0, 0.0, 30.0);
    assert!(rig.part().held);
    rig.outputs.grip.bits = valve::SUPPLY | valve::VENT;
    rig.ticks(50);
    assert!(!rig.part().held && rig.part().location == "UNIT_1", "{:?}", rig.part());
}

#[test]
fn carried_part_pushed_against_a_wall_slips() {
    let mut rig = Rig::new(&description(), 1);
    rig.place("LINKBAR1_BH", 4, 0.0, 0.0, 0.0);
    rig.pick(0.0, 0.0, 0.0, 30.0);
    // Down between the fingers: to the tray floor, and 0.3 in farther.
    rig.go_and_stop(rig.grip_frame(4, 0.0, 0.0, 0.0, -0.15), 2.0);
    assert!(
        matches!(rig.log.as_slice(), [CellEvent::Slipped { .. }]),
        "{:?} {:?} {:?} {:?}",
        rig.log,
        rig.part(),
        rig.cell.fingers(),
        in_fingers(&rig)
    );
    assert!((rig.part().position[2] + 16.2375).abs() < 0.05, "not into the floor: {:?}", rig.part());
}

#[test]
fn bar_of_another_size_needs_only_data() {
    let text = format!(
        "{}\n[[part]]\nname = \"LINKBAR2_BH\"\nsize = [1.0, 1.0, 5.0]\nweight = 1.4\nvision_id = 21\n",
        rig::CELL
    );
    let mut rig = Rig::new(&plant::CellDescription::from_toml(&text).unwrap(), 3);
    let action = WorkstationAction::Place {
        part: "LINKBAR2_BH".into(),
        unit: "UNIT_1".into(),
        sector: 4,
        placement: Placement::At { x: 0.0, y: 0.0, angle: 15.0 },
    };
    rig.cell.workstation(&action).unwrap();
    rig.pick(0.0, 0.0, 15.0, 30.0);
    assert!(
        rig.part().held && (rig.cell.fingers().0 - 1.0).abs() < 0.001,
        "{:?} {:?}",
        rig.part(),
        rig.cell.fingers()
    );
}
