//! Chains of grips: positions of clevis, turned part and tools after each transfer agree with the cell.

use std::path::Path;

use geometry::{
    frame::{Frame, Vector, rotation_by},
    pose::Pose,
};
use rcs_core::name::Name16;
use taskdata::{
    files::{Location, SensorSource, TaskData},
    load::{Diagnostics, Store},
};

fn data_directory() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"))
}

fn load() -> Store {
    let loaded: Result<(Store, Diagnostics), _> = Store::load(data_directory());
    loaded.unwrap_or_else(|report| panic!("{report}")).0
}

fn cell() -> toml::Table {
    std::fs::read_to_string(data_directory().join("cell.toml")).unwrap().parse().unwrap()
}

fn name(text: &str) -> Name16 {
    Name16::new(text).unwrap()
}

fn at(data: &TaskData<'_>, location: &str, sector: i32, object: &str) -> Location {
    data.resolve_location(&name(location), (sector != 0).then_some(sector), Some(&name(object)))
        .unwrap_or_else(|error| panic!("{error}"))
}

fn grip(data: &TaskData<'_>, object: &str, grip: i32, location: &str, sector: i32) -> Frame {
    data.grip_frame(&name(object), grip, &at(data, location, sector, object))
        .unwrap_or_else(|error| panic!("{error}"))
}

/// `inner` in the axes of `outer`.
fn seen_from(outer: &Frame, inner: &Frame) -> Frame {
    outer.inverse().compose(inner)
}

/// The frame of a part, gripped with the tool at `from` and released at `to`.
fn carried(part: &Frame, from: &Frame, to: &Frame) -> Frame {
    to.compose(&seen_from(from, part))
}

fn assert_at(found: &Frame, position: [f64; 3], square: bool) {
    for (value, expected) in found.position.iter().zip(position) {
        assert!((value - expected).abs() < 1e-9, "{:?} for {position:?}", found.position);
    }
    assert!(!square || found.distance(&Frame::identity()).radians < 1e-9, "{:?}", found.rotation);
}

fn numbers<const N: usize>(value: &toml::Value) -> [f64; N] {
    let all: Vec<f64> = value.as_array().unwrap().iter().map(|v| v.as_float().unwrap()).collect();
    all.try_into().unwrap()
}

fn taught(value: &toml::Value) -> Frame {
    let point = |key: &str| {
        let all: Vec<i32> = value[key]
            .as_array()
            .unwrap()
            .iter()
            .map(|v| i32::try_from(v.as_integer().unwrap()).unwrap())
            .collect();
        all.try_into().unwrap()
    };
    Pose { wrist: point("wrist"), tool: point("tool"), finger: point("finger") }.to_frame().unwrap()
}

/// The part's frame in the tray is on the floor, X down; `height`, in.
fn lying(floor: &Frame, height: f64) -> Frame {
    floor.shifted(Vector::new(-height / 2.0, 0.0, 0.0))
}

const CLEVIS: [f64; 3] = [1.73, 1.68, 1.63]; // heights of the lying clevis, in: blank, half finished, finished
const CLEVIS_WIDTH: f64 = 2.56;
const CLEVIS_LENGTH: f64 = 4.00;

fn clevis_seat(height: f64) -> [f64; 3] {
    let vise = &cell()["vise"];
    let programs = vise["program"].as_array().unwrap();
    let program = programs.iter().find(|p| p["name"].as_str() == Some("CLEVIS")).unwrap();
    let value = |key: &str| program[key].as_float().unwrap();
    [value("back") - height / 2.0, CLEVIS_WIDTH / 2.0 - value("depth"), value("ledge") + CLEVIS_LENGTH / 2.0]
}

#[test]
fn clevis_blank_is_released_before_its_seat() {
    let store = load();
    let data = store.view();
    let tray = at(&data, "UNIT_1", 3, "LCLEVIS_BH").frame;
    let blank = lying(&tray, CLEVIS[0]);
    let pick = grip(&data, "LCLEVIS_BH", 2, "UNIT_1", 3);
    let place = grip(&data, "LCLEVIS_BH", 2, "PFIXTURE", 0);
    let vise = at(&data, "PFIXTURE", 0, "LCLEVIS_BH").frame;
    let [x, y, z] = clevis_seat(CLEVIS[0]);
    // The blank is 0.04 before the back, 0.05 above the ledge, in the middle of the partly closed jaws.
    assert_at(&seen_from(&vise, &carried(&blank, &pick, &place)), [x - 0.04, y + 0.04, z + 0.05], true);
    // The seat position is 0.01 beyond the front face of a seated blank.
    let seat = seen_from(&vise, &grip(&data, "S-LCLEVIS_BH", 1, "PFIXTURE", 0));
    assert!((seat.position.x - (x - CLEVIS[0] / 2.0) - 0.01).abs() < 1e-9, "{seat:?}");
}

#[test]
fn half_done_clevis_returns_turned_around() {
    let store = load();
    let data = store.view();
    let vise = at(&data, "PFIXTURE", 0, "LCLEVIS_IH").frame;
    let pedestal = at(&data, "PEDESTAL", 0, "LCLEVIS_IH").frame;
    let [x, y, z] = clevis_seat(CLEVIS[1]);
    let seated = vise.shifted(Vector::new(x, y, z));

    let brought = carried(
        &seated,
        &grip(&data, "LCLEVIS_IH", 1, "PFIXTURE", 0),
        &grip(&data, "LCLEVIS_IH", 1, "PEDESTAL", 0),
    );
    // The part is on the axis of the table; the pedestal's hand grips the lowest inch.
    assert_at(&seen_from(&pedestal, &brought), [0.0, 0.0, 1.0], true);
    let half_turn = Frame {
        position: Vector::zeros(),
        rotation: rotation_by(&Vector::new(0.0, 0.0, core::f64::consts::PI)),
    };
    let flipped = pedestal.compose(&half_turn.compose(&seen_from(&pedestal, &brought)));
    let back = carried(
        &flipped,
        &grip(&data, "LCLEVIS_IH", -1, "PEDESTAL", 0),
        &grip(&data, "LCLEVIS_IH", -1, "PFIXTURE", 0),
    );
    let there = seen_from(&vise, &back);
    assert_at(&there, [x - 0.04, y + 0.04, z + 0.05], false);
    assert!((there.x() + Vector::x()).norm() < 1e-9, "what was at the back is in front");
    let seat = seen_from(&vise, &grip(&data, "S-LCLEVIS_IH", 1, "PFIXTURE", 0));
    assert!((seat.position.x - (x - CLEVIS[1] / 2.0) - 0.01).abs() < 1e-9, "{seat:?}");
}

#[test]
fn finished_clevis_is_released_just_above_the_tray() {
    let store = load();
    let data = store.view();
    let vise = at(&data, "PFIXTURE", 0, "LCLEVIS").frame;
    let [x, y, z] = clevis_seat(CLEVIS[2]);
    let seated = vise.shifted(Vector::new(x, y, z));
    let tray = at(&data, "UNIT_1", 2, "LCLEVIS").frame;
    let laid =
        carried(&seated, &grip(&data, "LCLEVIS", 1, "PFIXTURE", 0), &grip(&data, "LCLEVIS", 1, "UNIT_1", 2));
    assert_at(&seen_from(&tray, &laid), [-CLEVIS[2] / 2.0 - 0.04, 0.0, 0.0], true);
}

#[test]
fn turned_part_is_upright_in_its_nest_and_flat_in_its_cradle() {
    let store = load();
    let data = store.view();
    for sector in [7, 8] {
        let cradle = at(&data, "UNIT_2", sector, "SHAFT_BH").frame;
        // The cradle is 1.17 in below the rim (Figure VIII.11), along world Y.
        assert!((cradle.position.z - -15.17).abs() < 1e-9 && (cradle.z() + Vector::y()).norm() < 1e-9);
        let nest = at(&data, "V-VFIXTURE", 0, "SHAFT_BH").frame;
        let brought = carried(
            &cradle,
            &grip(&data, "SHAFT_BH", 1, "UNIT_2", sector),
            &grip(&data, "SHAFT_BH", 1, "V-VFIXTURE", 0),
        );
        let seat = nest.shifted(Vector::new(1.50, 0.0, 1.50));
        assert_at(&seen_from(&nest, &brought), [1.50, 0.0, 1.55], true);
        let back = carried(
            &seat,
            &grip(&data, "SHAFT", -1, "V-VFIXTURE", 0),
            &grip(&data, "SHAFT", -1, "UNIT_2", sector),
        );
        assert_at(&seen_from(&cradle, &back), [0.0, 0.0, 0.0], true);
    }
}

#[test]
fn holsters_drum_and_pedestal_agree_with_the_cell() {
    let store = load();
    let data = store.view();
    let cell = cell();
    for (location, side) in [("HOLSTER-R", "right"), ("HOLSTER-L", "left"), ("HOLSTER-C", "centre")] {
        let apart = at(&data, location, 0, "GRIPPER-1").frame.distance(&taught(&cell["holsters"][side]));
        assert!(apart.inches < 1e-9 && apart.radians < 1e-9, "{location}: {apart:?}");
    }
    let drum = at(&data, cell["drum"]["location"].as_str().unwrap(), 0, "ENDMILL-1").frame;
    let apart = drum.distance(&taught(&cell["drum"]["pose"]));
    assert!(apart.inches < 0.01 && apart.radians < 1e-3, "{apart:?}");
    let pedestal = at(&data, cell["pedestal"]["location"].as_str().unwrap(), 0, "LCLEVIS_IH").frame;
    let [x, y, z] = numbers(&cell["pedestal"]["position"]);
    assert!((pedestal.position - Vector::new(x, y, z)).norm() < 1e-9);
    let azimuth = cell["pedestal"]["azimuth"].as_float().unwrap();
    assert!((pedestal.x().y.atan2(pedestal.x().x).to_degrees() - azimuth).abs() < 0.02);
}

#[test]
fn every_gripper_has_its_holster() {
    let store = load();
    let data = store.view();
    for (number, holster) in [(1, "HOLSTER-R"), (2, "HOLSTER-L"), (3, "HOLSTER-C")] {
        let gripper = format!("GRIPPER-{number}");
        assert_eq!(data.obj_grips(&name(&gripper)).unwrap().endeff_id, number);
        let rest = at(&data, holster, 0, &gripper).frame;
        // The robot is 3 in above the holster with the gripper; without it, above the seat.
        assert_at(&seen_from(&rest, &grip(&data, &gripper, 1, holster, 0)), [-3.0, 0.0, 0.0], true);
        assert_at(&seen_from(&rest, &grip(&data, &gripper, 2, holster, 0)), [-3.0, 0.0, 1.5], true);
    }
}

#[test]
fn forces_of_guarded_moves_have_the_sign_of_the_reaction() {
    let store = load();
    let data = store.view();
    for (sensor, source, threshold) in [
        // The drum pushes along -X on a tool that is inserted.
        ("INS-FX", SensorSource::Fx, -60),
        // The strike plate pushes the tool along -X.
        ("ACQ-FX", SensorSource::Fx, -25),
        // The drum pulls along +X on a tool that is removed.
        ("REM-FX", SensorSource::Fx, 60),
        // The tool moves right, along -Z. The shoulder pushes it along +Z in front of the sensor, a moment about -Y.
        ("REL-MY", SensorSource::My, -150),
        ("ACQ-MY", SensorSource::My, 150),
    ] {
        let record = data.sensor(&name(sensor)).unwrap();
        assert_eq!((record.source, record.threshold), (source, threshold), "{sensor}");
    }
}
