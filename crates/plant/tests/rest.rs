//! Bodies at rest stay at rest: parts that are held or stacked for a minute, and the arm at its command.
//!
//! The linkbar job depends on gaps of a millimetre (cell proposal, §2): 0.5 mm per minute is permitted, the limit here
//! is 0.1 mm.

use crate::rig::{self, CELL, Rig, UNIT_V1, description, scenes, table};
use geometry::{
    frame::{Frame, Vector, rotation_by, rotation_from_x_y, rotation_vector},
    movetable::System,
};
use interfaces::device::JawValves;
use plant::{CellDescription, WorkstationAction};

const MINUTE: u32 = 1500; // ticks
const LIMIT: f64 = 0.1 / 25.4; // 0.1 mm, in

fn with_block(weight: f64) -> CellDescription {
    let text = format!("{CELL}\n[[part]]\nname = \"BLOCK\"\nsize = [2.0, 2.0, 2.0]\nweight = {weight}\n");
    CellDescription::from_toml(&text).unwrap()
}

/// Distance that the last part moves in the fingers in a minute, in, and its rotation at a lever of 2 in.
fn creep(rig: &mut Rig) -> f64 {
    rig.ticks(50);
    let in_fingers = |rig: &Rig| rig.cell.tool().inverse().compose(&rig.part_frame());
    let before = in_fingers(rig);
    assert!(rig.part().held, "{:?} {:?}", rig.part(), rig.log);
    rig.ticks(MINUTE);
    let after = in_fingers(rig);
    let turned = rotation_vector(&(before.rotation.inverse() * after.rotation)).norm();
    (after.position - before.position).norm() + 2.0 * turned
}

#[test]
fn bar_gripped_at_its_end_stays_with_the_force_of_the_job() {
    for (force, angle) in [(30.0, 0.0), (45.0, 40.0), (60.0, -75.0)] {
        let mut rig = Rig::new(&description(), 1);
        rig.place("LINKBAR1_BH", 4, 0.0, 0.0, angle);
        rig.pick(0.0, 0.0, angle, force);
        let crept = creep(&mut rig);
        assert!(crept < LIMIT, "{force} lb, {angle} degrees: {crept} in");
    }
}

#[test]
fn bar_held_level_or_upright_stays() {
    let mut rig = Rig::new(&description(), 1);
    rig.place("LINKBAR1_BH", 4, 0.0, 0.0, 0.0);
    rig.pick(0.0, 0.0, 0.0, 30.0);
    rig.carry();
    rig.go_and_stop(Rig::fixture(&rig::FX1, 10.0, 0.0), 10.0);
    let upright = creep(&mut rig);
    let present = Rig::fixture(&rig::FX1, 10.0, 0.0);
    for roll in [90.0_f64, 45.0] {
        rig.go_and_stop(present.turned(&rotation_by(&Vector::new(roll.to_radians(), 0.0, 0.0))), 6.0);
        let level = creep(&mut rig);
        assert!(level < LIMIT && upright < LIMIT, "roll {roll}: {level} in, upright {upright}");
    }
    assert!(rig.log.is_empty(), "{:?}", rig.log);
}

#[test]
fn block_near_the_limit_of_friction_stays() {
    // 2 x 50 lb x 0.30 carry 30 lb: this is 0.9 of it.
    let mut rig = Rig::new(&with_block(27.0), 1);
    rig.place("BLOCK", 4, 0.0, 0.0, 0.0);
    let sector = description().tray("UNIT_1").unwrap().sector(4).unwrap();
    let grip = table(&[(System::Tool, [-60, 0, 0]), (System::ToolOrigin, [-300, 0, 0])]).apply(&sector);
    rig.go(UNIT_V1.to_frame().unwrap(), 10.0);
    rig.open(3.0);
    rig.go(grip.shifted(Vector::new(-8.0, 0.0, 0.0)), 10.0);
    rig.go_and_stop(grip, 4.0);
    rig.close(50.0);
    rig.go_and_stop(grip.shifted(Vector::new(-3.0, 0.0, 0.0)), 0.5);
    let crept = creep(&mut rig);
    assert!(crept < LIMIT, "{crept} in, {:?}", rig.log);
}

#[test]
fn shaft_in_the_grooves_of_the_v_gripper_stays() {
    let text = CELL.replace("mounted = \"parts\"", "mounted = \"v\"");
    let mut rig = Rig::new(&CellDescription::from_toml(&text).unwrap(), 1);
    let placement = plant::Placement::At { x: 0.0, y: 0.0, angle: 0.0 };
    let (part, unit) = ("SHAFT_BH".into(), "UNIT_2".into());
    rig.work(WorkstationAction::Place { part, unit, sector: 7, placement });
    rig.ticks(10);
    let seat = Frame {
        position: Vector::new(-48.50, -26.45, -15.17),
        rotation: rotation_from_x_y(&-Vector::z(), &Vector::x()).unwrap(),
    };
    let grip = table(&[(System::Tool, [60, 0, 0]), (System::ToolOrigin, [-300, 0, 0])]).apply(&seat);
    rig.go(UNIT_V1.to_frame().unwrap(), 10.0);
    rig.outputs.v_grip = JawValves { open: true, close: false };
    rig.go(grip.shifted(Vector::new(-8.0, 0.0, 0.0)), 10.0);
    rig.go_and_stop(grip, 4.0);
    rig.outputs.v_grip = JawValves { open: false, close: true };
    rig.ticks(60);
    rig.go_and_stop(grip.shifted(Vector::new(-5.0, 0.0, 0.0)), 4.0);
    let crept = creep(&mut rig);
    assert!(crept < LIMIT, "{crept} in, {:?}", rig.log);
}

#[test]
fn tools_in_tool_gripper_and_drum_stay() {
    let mut rig = scenes::drumming(1);
    let before = rig.part_frame();
    rig.ticks(MINUTE);
    let moved = (rig.part_frame().position - before.position).norm();
    assert!(rig.part().location == "TOOL-TRNS" && moved < LIMIT, "{moved} {:?}", rig.part());

    let mut rig = scenes::with_tool_in_hand(1);
    let crept = creep(&mut rig);
    assert!(crept < LIMIT, "{crept} in, {:?}", rig.log);
}

#[test]
fn part_in_the_pedestal_hand_stays() {
    let mut rig = Rig::new(&description(), 1);
    rig.table_square();
    rig.pedestal_open(4.0);
    let upright = rotation_from_x_y(&Vector::x(), &Vector::y()).unwrap();
    let frame = Frame { position: Vector::new(0.0, 0.1, -0.998), rotation: upright };
    let frame = rig::PED.to_frame().unwrap().compose(&frame);
    rig.work(WorkstationAction::Put { part: "LCLEVIS_IH".into(), frame });
    rig.pedestal_close(50.0);
    rig.ticks(50);
    let before = rig.part_frame();
    rig.ticks(MINUTE);
    let moved = (rig.part_frame().position - before.position).norm();
    assert!(moved < LIMIT, "{moved} in");
}

/// A pile in sector 4: the distance that each part moves in a minute, and its depth below its nominal height.
fn pile(description: &CellDescription, parts: &[(&str, f64)]) -> Vec<(f64, f64)> {
    let mut rig = Rig::new(description, 1);
    let sector = description.tray("UNIT_1").unwrap().sector(4).unwrap();
    let mut top = 0.0;
    let mut nominal = Vec::new();
    for (part, angle) in parts {
        let height = description.part(part).unwrap().size[0];
        nominal.push(sector.position.z + top + height / 2.0);
        let frame = sector
            .shifted(Vector::new(-(top + height / 2.0 + 1e-4), 0.0, 0.0))
            .turned(&rotation_by(&Vector::new(angle.to_radians(), 0.0, 0.0)));
        rig.work(WorkstationAction::Put { part: (*part).into(), frame });
        top += height;
    }
    rig.ticks(25);
    let before: Vec<Frame> = (1..).take(parts.len()).map(|id| rig.cell.part_frame(id).unwrap()).collect();
    rig.ticks(MINUTE);
    let after = (1..).take(parts.len()).map(|id| rig.cell.part_frame(id).unwrap().position);
    let each = after.zip(before).zip(nominal);
    each.map(|((after, before), nominal)| ((after - before.position).norm(), nominal - after.z)).collect()
}

#[test]
fn piles_of_five_neither_sink_nor_creep() {
    let bar = "LINKBAR1_BH";
    let piles: [[(&str, f64); 5]; 3] = [
        [(bar, 0.0); 5],
        // Crosswise, and heavy parts on light ones.
        [("LCLEVIS_BH", 0.0), (bar, 0.0), ("LCLEVIS", 30.0), ("LCLEVIS_IH", 120.0), ("BLOCK", 10.0)],
        [("BLOCK", 0.0), ("BLOCK", 20.0), ("BLOCK", 40.0), ("BLOCK", 60.0), ("BLOCK", 80.0)],
    ];
    for parts in &piles {
        for (layer, (crept, low)) in pile(&with_block(8.0), parts).into_iter().enumerate() {
            assert!(crept < LIMIT, "{parts:?}, layer {layer} creeps by {crept} in");
            assert!(low < LIMIT * 2.0, "{parts:?}, layer {layer} lies {low} in low");
        }
    }
}

#[test]
fn arm_at_rest_is_within_0_01_in_of_its_command() {
    let mut rig = Rig::new(&description(), 1);
    rig.place("LINKBAR1_BH", 4, 0.0, 0.0, 0.0);
    rig.pick(0.0, 0.0, 0.0, 30.0);
    let fixture = |back| Rig::fixture(&rig::FX1, back, 0.0);
    let poses =
        [rig::UNIT_V1, rig::HOM_SAF_3, rig::HOM_SAF_1, rig::FIX_V1].map(|pose| pose.to_frame().unwrap());
    let mut greatest = 0.0_f64;
    for command in poses.into_iter().chain([fixture(10.0), fixture(5.0), fixture(10.0), poses[3], poses[2]]) {
        rig.go_and_stop(command, 10.0);
        let away = (rig.cell.tool().position - command.position).norm();
        assert!(away < 0.01, "{away} in at {command:?}");
        greatest = greatest.max(away);
    }
    assert!(greatest > 1e-5, "the words of the line are rounded: {greatest}");
}
