//! Conversion of true values to words: noise, weight and bias, dead time, light, and hidden parts.

use crate::rig::{Rig, UNIT_V1, description, table};
use geometry::{frame::Vector, movetable::System};
use interfaces::device::{
    FORCE_COUNTS_PER_LB, FORCE_ZERO, Picture, RESOLVER_COUNTS, VisionRequest, VisionResponse, VisionStatus,
    valve,
};
use plant::description::Mounted;

fn with_tool_gripper(noise: f64) -> Rig {
    let mut cell = description();
    cell.quick_change.mounted = Mounted::Tool;
    cell.gripper.force.noise = noise;
    Rig::new(&cell, 1)
}

/// The mean force along tool X (sensor Z) over some ticks, as a controller without a bias computes it, lb.
fn along_tool(rig: &mut Rig) -> f64 {
    let read = (0..10).map(|_| {
        rig.tick();
        f64::from(i32::from(rig.inputs.force.z) - FORCE_ZERO) / f64::from(FORCE_COUNTS_PER_LB)
    });
    read.sum::<f64>() / 10.0
}

#[test]
fn force_without_calibration_is_wrong() {
    let mut rig = with_tool_gripper(3.0);
    rig.ticks(10);
    // The drum's guarded moves stop at 25 lb. With the raw reading they would stop at almost twice as much.
    let bias = along_tool(&mut rig);
    assert!((20.0..28.0).contains(&bias), "{bias} lb of weight and offset at HOME");
    // Like CAL-SENSOR: subtract the mean of ten readings at rest. A tenth of 25 lb is then detected.
    let calibrated = along_tool(&mut rig) - bias;
    assert!(calibrated.abs() < 0.2, "{calibrated} lb");
    // The direction of the weight turns with the robot: a bias from another attitude is wrong.
    rig.go_and_stop(UNIT_V1.to_frame().unwrap(), 10.0);
    let elsewhere = along_tool(&mut rig) - bias;
    assert!(elsewhere.abs() > 4.0, "{elsewhere} lb");
}

#[test]
fn resolvers_are_exact_by_default() {
    let read = |noise: f64| {
        let mut cell = description();
        cell.sensors.resolver_noise = noise;
        let mut rig = Rig::new(&cell, 1);
        rig.ticks(5);
        let truth = rig.cell.joints();
        let words: Vec<_> = (0..100)
            .flat_map(|_| {
                rig.tick();
                rig.inputs.resolvers.counts
            })
            .collect();
        let away = words.iter().zip(truth.iter().cycle()).map(|(count, angle)| {
            let turns = (f64::from(*count) / f64::from(RESOLVER_COUNTS)
                - angle / (2.0 * core::f64::consts::PI))
                .rem_euclid(1.0);
            turns.min(1.0 - turns) * f64::from(RESOLVER_COUNTS)
        });
        away.fold(0.0, f64::max)
    };
    assert!(read(0.0) < 1.0);
    let noisy = read(8.0);
    assert!((6.0..9.0).contains(&noisy), "{noisy} counts");
}

#[test]
fn late_converters_show_old_values() {
    let mut cell = description();
    cell.sensors.converter_delay = 5;
    cell.gripper.parts.sensors.noise = 0.0;
    let mut rig = Rig::new(&cell, 1);
    rig.ticks(10);
    let before = rig.inputs.grip.potentiometer;
    rig.outputs.grip.bits = valve::SUPPLY | valve::OPEN_MEDIUM;
    rig.ticks(5);
    assert_eq!(
        rig.inputs.grip.potentiometer, before,
        "the fingers have moved, and the sensor does not show it"
    );
    assert!(rig.cell.fingers().0 > 0.29);
    rig.tick();
    // 1 in/s is 28 counts per tick.
    assert_eq!(rig.inputs.grip.potentiometer, before + 28);
}

fn look(rig: &mut Rig, number: u32, variation: u8, aside: [f64; 2]) -> VisionResponse {
    let sector = description().tray("UNIT_1").unwrap().sector(4).unwrap();
    let place = sector.shifted(Vector::new(0.0, aside[0], aside[1]));
    let view = table(&[(System::Tool, [-1468, 0, -252]), (System::ToolOrigin, [-300, 0, 0])]).apply(&place);
    rig.go_and_stop(view, 10.0);
    let picture = Picture::Precise;
    rig.outputs.vision = VisionRequest { number, picture, object_id: 17, grip: 2, range_mm: 590, variation };
    rig.ticks(20);
    assert_eq!(rig.inputs.vision.echo, number);
    rig.inputs.vision
}

fn at_unit(reflectance: f64) -> Rig {
    let mut cell = description();
    for part in &mut cell.part {
        part.reflectance = reflectance;
    }
    let mut rig = Rig::new(&cell, 5);
    rig.go(UNIT_V1.to_frame().unwrap(), 10.0);
    rig.open(5.0);
    rig
}

#[test]
fn dark_and_shiny_parts_need_different_exposures() {
    for (reflectance, expected) in [
        (0.5, [VisionStatus::Done, VisionStatus::NotRecognised, VisionStatus::Done]),
        (0.08, [VisionStatus::NothingSeen, VisionStatus::Done, VisionStatus::NothingSeen]),
        (0.95, [VisionStatus::NotRecognised, VisionStatus::NotRecognised, VisionStatus::Done]),
    ] {
        let mut rig = at_unit(reflectance);
        rig.place("LINKBAR1_BH", 4, 0.0, 0.0, 0.0);
        let seen =
            [0, 1, 2].map(|variation| look(&mut rig, u32::from(variation) + 1, variation, [0.0; 2]).status);
        assert_eq!(seen, expected, "reflectance {reflectance}");
    }
}

#[test]
fn hidden_part_is_not_recognised() {
    let mut rig = at_unit(0.5);
    rig.place("LINKBAR1_BH", 4, 0.0, 0.0, 0.0);
    assert_eq!(look(&mut rig, 1, 0, [0.0; 2]).recognised, Some(17));
    // A clevis blank so near to the bar that both are one blob.
    rig.place("LCLEVIS_BH", 4, 0.0, -1.61, 0.0);
    assert_eq!(look(&mut rig, 2, 0, [0.0; 2]).status, VisionStatus::NotRecognised);
}

#[test]
fn nearest_part_to_the_middle_is_selected() {
    let mut rig = at_unit(0.5);
    rig.place("LINKBAR1_BH", 4, 0.0, 1.5, 0.0);
    rig.place("LCLEVIS_BH", 4, 0.0, -3.0, 0.0);
    let seen = look(&mut rig, 1, 0, [0.0; 2]);
    // Tool Y is world -Y.
    assert_eq!(seen.recognised, Some(17));
    assert!((seen.y + 150).abs() <= 3, "{seen:?}");
}
