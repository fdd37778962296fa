//! The cell through the controller's devices: link, resolvers, gripper sensors, camera, and data for viewers.

use crate::rig::{Rig, UNIT_V1, description, table};
use depc::{
    Plate,
    controller::Warning,
    wire::{DataCommand, NO_FUNCTION, Report},
};
use geometry::{
    frame::Vector,
    kinematics::{HOME_JOINTS, T3},
    movetable::System,
};
use interfaces::device::{
    DeviceInputs, DeviceOutputs, Picture, RESOLVER_COUNTS, VisionRequest, VisionResponse, VisionStatus, valve,
};
use plant::{Cell, CellEvent, Half, Key, Placement, WorkstationAction, WorkstationError};
use rcs_core::Plain;

fn bytes(inputs: &DeviceInputs) -> Vec<u8> {
    let mut image = vec![0; DeviceInputs::SCHEMA.size()];
    inputs.encode(&mut rcs_core::plain::Writer::new(&mut image));
    image
}

#[test]
fn data_commands_move_the_arm() {
    let mut cell = Cell::new(&description(), 1).unwrap();
    assert!(
        !cell.inputs().link_ready && cell.inputs().link_rx.length == 0,
        "before the first tick the line is dead"
    );
    let mut outputs = DeviceOutputs::default();
    let report = Report::parse(cell.step(&outputs).link_rx.as_slice()).unwrap();
    let mut plate = report.plate;
    for _ in 0..50 {
        plate.words[2] += 20;
        let mut frame = [0; 16];
        DataCommand { function: NO_FUNCTION, plate }.emit(&mut frame);
        outputs.link_tx = Default::default();
        outputs.link_tx.extend(&frame);
        let inputs = cell.step(&outputs);
        assert_eq!(inputs.link_rx.as_slice(), [0x06]);
        assert!(inputs.link_ready);
    }
    outputs.link_tx = Default::default();
    for _ in 0..40 {
        cell.step(&outputs);
    }
    let at = Plate::from_frame(&T3.forward_plate(&cell.joints()), &plate).unwrap();
    assert_eq!(at, plate, "10 in higher");
    let tool = cell.tool();
    let unloaded = T3.forward(&cell.joints());
    assert!((tool.position - unloaded.position).norm() < 1e-4, "fingers without load hang where the arm is");
}

#[test]
fn cell_follows_a_robot_outside() {
    let mut cell = Cell::new(&description(), 1).unwrap();
    let home = Plate::from_frame(&T3.forward_plate(&cell.joints()), &Plate::default()).unwrap();
    let outputs = DeviceOutputs::default();
    let before = cell.inputs().resolvers;
    assert_eq!(cell.step_following(None, &outputs).resolvers, before, "the position of the robot is unknown");
    let mut there = home;
    there.words[2] += 200;
    for _ in 0..60 {
        let inputs = cell.step_following(Some(&there), &outputs);
        assert!(!inputs.link_ready && inputs.link_rx.length == 0, "the line is elsewhere");
    }
    assert_eq!(Plate::from_frame(&T3.forward_plate(&cell.joints()), &there).unwrap(), there);
    assert_eq!(cell.events(), []);
    let mut beyond = there;
    beyond.words[2] = 20_000;
    for _ in 0..3 {
        cell.step_following(Some(&beyond), &outputs);
    }
    let events = cell.events();
    assert!(matches!(events[..], [CellEvent::CannotFollow(_)]), "said once: {events:?}");
    assert_eq!(Plate::from_frame(&T3.forward_plate(&cell.joints()), &there).unwrap(), there);
}

#[test]
fn halves_of_a_tick_move_like_whole_ticks() {
    let mut whole = Cell::new(&description(), 1).unwrap();
    let mut halves = whole.clone();
    let mut there = Plate::from_frame(&T3.forward_plate(&whole.joints()), &Plate::default()).unwrap();
    let outputs = DeviceOutputs::default();
    for _ in 0..60 {
        there.words[2] += 4;
        whole.step_following(Some(&there), &outputs);
        for half in [Half::First, Half::Second] {
            halves.step_half_following(half, Some(&there), &outputs);
        }
        for (joint, other) in whole.joints().into_iter().zip(halves.joints()) {
            // The arm of the halves reaches a position after 20 ms, the other one after 40 ms.
            assert!((joint - other).abs() < 2e-3, "{joint} and {other}");
        }
    }
    assert_eq!((whole.events(), halves.events()), (vec![], vec![]));
}

#[test]
fn jump_causes_a_warning_for_the_operator() {
    let mut cell = Cell::new(&description(), 1).unwrap();
    let mut outputs = DeviceOutputs::default();
    let mut plate = Report::parse(cell.step(&outputs).link_rx.as_slice()).unwrap().plate;
    plate.words[0] += 100;
    let mut frame = [0; 16];
    DataCommand { function: NO_FUNCTION, plate }.emit(&mut frame);
    outputs.link_tx.extend(&frame);
    cell.step(&outputs);
    assert_eq!(cell.events(), [CellEvent::Warning(Warning::Translation)]);
    outputs = DeviceOutputs::default();
    assert_eq!(cell.step(&outputs).link_rx.length, 0, "silence");
    cell.press(Key::Enter).unwrap();
    assert!(Report::parse(cell.step(&outputs).link_rx.as_slice()).is_ok());
    assert!((cell.joints()[0] - HOME_JOINTS[0]).abs() < 1e-12, "it has not moved");
}

#[test]
fn resolvers_follow_the_joints() {
    let mut rig = Rig::new(&description(), 1);
    rig.go_and_stop(UNIT_V1.to_frame().unwrap(), 10.0);
    let joints = rig.cell.joints();
    for (count, angle) in rig.inputs.resolvers.counts.iter().zip(joints) {
        let read = f64::from(*count) / f64::from(RESOLVER_COUNTS) * 360.0;
        let off = (read - angle.to_degrees()).rem_euclid(360.0);
        assert!(off.min(360.0 - off) < 0.0014, "{read} for {}", angle.to_degrees());
    }
}

#[test]
fn gripper_sensors_measure_opening_force_and_part() {
    let mut rig = Rig::new(&description(), 1);
    let free = rig.inputs.grip;
    assert_eq!(free.beams, 0);
    rig.outputs.grip.bits = valve::SUPPLY | valve::CLOSE_MEDIUM;
    rig.ticks(8);
    rig.outputs.grip.bits = valve::SUPPLY;
    rig.tick();
    let pressed = rig.inputs.grip;
    // Closed without a part, the fingers press on their stop: 1 in/s for 0.32 s at 100 lb/in.
    assert!((f64::from(pressed.strain_left - free.strain_left) - 32.0 * 40.5).abs() < 4.0, "{pressed:?}");
    assert!(pressed.potentiometer.abs_diff(free.potentiometer) <= 2);
    rig.place("LINKBAR1_BH", 4, 0.0, 0.0, 0.0);
    rig.pick(0.0, 0.0, 0.0, 30.0);
    let held = rig.inputs.grip;
    assert!((f64::from(held.potentiometer) - (205.0 + 700.0 * 0.625)).abs() < 3.0, "{held:?}");
    assert_eq!(held.beams, 0b0000_0011, "the bar covers one side of the fingers, 0.42 in deep");
}

fn look(
    rig: &mut Rig,
    number: u32,
    picture: Picture,
    object_id: u16,
    shift: [f64; 2],
    roll: f64,
) -> VisionResponse {
    let sector = description().tray("UNIT_1").unwrap().sector(4).unwrap();
    let place = sector
        .shifted(Vector::new(0.0, shift[0], shift[1]))
        .turned(&geometry::frame::rotation_by(&Vector::new(roll, 0.0, 0.0)));
    let view = table(&[(System::Tool, [-1468, 0, -252]), (System::ToolOrigin, [-300, 0, 0])]).apply(&place);
    rig.go_and_stop(view, 10.0);
    rig.outputs.vision = VisionRequest { number, picture, object_id, grip: 2, range_mm: 590, variation: 0 };
    rig.tick();
    assert_eq!((rig.inputs.vision.status, rig.inputs.vision.echo), (VisionStatus::Busy, number));
    rig.ticks(20);
    assert_eq!(rig.inputs.vision.echo, number);
    rig.inputs.vision
}

#[test]
fn camera_finds_a_blank_and_its_angle() {
    let mut rig = Rig::new(&description(), 5);
    rig.place("LINKBAR1_BH", 4, 1.4, -1.1, 25.0);
    rig.go(UNIT_V1.to_frame().unwrap(), 10.0);
    rig.open(5.0);
    let flood = look(&mut rig, 1, Picture::FastFlood, 17, [0.0, 0.0], 0.0);
    // Tool Y is world -Y, tool Z is world -X.
    assert_eq!(flood.status, VisionStatus::Done);
    assert!((flood.y - 110).abs() <= 7 && (flood.z + 140).abs() <= 7, "{flood:?}");
    let found = [f64::from(flood.y) / 100.0, f64::from(flood.z) / 100.0];
    let precise = look(&mut rig, 2, Picture::Precise, 17, found, 0.0);
    assert_eq!((precise.status, precise.recognised), (VisionStatus::Done, Some(17)));
    let [y, z] = found;
    assert!((y + f64::from(precise.y) / 100.0 - 1.1).abs() < 0.02, "{precise:?}");
    assert!((z + f64::from(precise.z) / 100.0 + 1.4).abs() < 0.02, "{precise:?}");
    assert!((precise.angle - 2500).abs() < 20, "{precise:?}");
    let stranger = look(&mut rig, 3, Picture::Precise, 14, found, 0.0);
    assert_eq!((stranger.status, stranger.recognised), (VisionStatus::NotRecognised, None));
}

#[test]
fn empty_sector_shows_no_part() {
    let mut rig = Rig::new(&description(), 5);
    rig.place("LINKBAR1_BH", 1, 0.0, 0.0, 0.0);
    rig.go(UNIT_V1.to_frame().unwrap(), 10.0);
    rig.open(5.0);
    assert_eq!(look(&mut rig, 1, Picture::FastFlood, 17, [0.0, 0.0], 0.0).status, VisionStatus::NothingSeen);
}

fn run(seed: u64) -> Vec<u8> {
    let mut rig = Rig::new(&description(), seed);
    let action = WorkstationAction::Place {
        part: "LINKBAR1_BH".into(),
        unit: "UNIT_1".into(),
        sector: 4,
        placement: Placement::Random,
    };
    rig.cell.workstation(&action).unwrap();
    let mut image = Vec::new();
    rig.pick(0.0, 0.0, 0.0, 0.0);
    for _ in 0..50 {
        rig.tick();
        image.extend(bytes(&rig.inputs));
    }
    let at = rig.part_frame();
    image.extend(at.position.iter().flat_map(|v| v.to_bits().to_le_bytes()));
    image.extend(at.rotation.matrix().iter().flat_map(|v| v.to_bits().to_le_bytes()));
    image
}

#[test]
fn equal_seeds_give_equal_bits() {
    assert_eq!(run(11), run(11));
    assert_ne!(run(11), run(12));
}

#[test]
fn part_is_placed_only_on_free_space() {
    let mut rig = Rig::new(&description(), 1);
    rig.place("LINKBAR1_BH", 4, 0.0, 0.0, 0.0);
    let place = |part: &str, unit: &str, sector| WorkstationAction::Place {
        part: part.into(),
        unit: unit.into(),
        sector,
        placement: Placement::At { x: 0.3, y: 0.0, angle: 0.0 },
    };
    let occupied = rig.cell.workstation(&place("LINKBAR1_BH", "UNIT_1", 4)).unwrap_err();
    assert_eq!(occupied.to_string(), "LINKBAR1_BH cannot be put there: LINKBAR1_BH is in the way");
    let unknown = rig.cell.workstation(&place("LINKBAR9", "UNIT_1", 3)).unwrap_err();
    let known = "no part named LINKBAR9; the cell description has LINKBAR1_BH, LINKBAR1, ";
    assert!(unknown.to_string().starts_with(known), "{unknown}");
    let unit = rig.cell.workstation(&place("LINKBAR1", "UNIT_3", 3)).unwrap_err();
    assert_eq!(unit.to_string(), "no unit named UNIT_3; the cell description has UNIT_2, UNIT_1");
    let sector = rig.cell.workstation(&place("LINKBAR1", "UNIT_1", 5)).unwrap_err();
    assert_eq!(sector.to_string(), "UNIT_1 has sectors 1 to 4 in the cell description, not 5");
    assert_eq!(
        rig.cell.workstation(&WorkstationAction::Remove { id: 7 }),
        Err(WorkstationError::NoSuchPart { id: 7 })
    );
}

#[test]
fn collision_with_a_tray_is_reported() {
    let mut rig = Rig::new(&description(), 1);
    rig.go(UNIT_V1.to_frame().unwrap(), 10.0);
    rig.go(rig.grip_frame(4, 0.0, 0.0, 0.0, 5.0), 10.0);
    rig.go_and_stop(rig.grip_frame(4, 0.0, 0.0, 0.0, -0.5), 2.0);
    let met: Vec<_> = rig
        .log
        .iter()
        .filter_map(|event| match event {
            CellEvent::Contact(contact) => Some((contact.mover.as_str(), contact.obstacle.as_str())),
            _ => None,
        })
        .collect();
    assert!(met.contains(&("left_finger", "UNIT_1_floor")), "{:?}", rig.log);
}

#[test]
fn every_moving_link_is_in_the_urdf() {
    let mut rig = Rig::new(&description(), 1);
    rig.place("LINKBAR1_BH", 4, 0.0, 0.0, 0.0);
    let urdf = rig.cell.scene(&[]).urdf();
    for link in rig.cell.links() {
        let child = format!("<child link=\"{}\"/>", link.name);
        let line = urdf
            .lines()
            .find(|line| line.contains(&child))
            .unwrap_or_else(|| panic!("no joint of {}", link.name));
        assert!(line.contains(&format!("<parent link=\"{}\"/>", link.parent)), "{line}");
        assert!(urdf.contains(&format!("<link name=\"{}\">", link.name)));
    }
    for (joint, _) in rig.cell.joint_states() {
        assert!(urdf.contains(&format!("<joint name=\"{joint}\" type=\"")), "{joint}");
    }
    assert_eq!(urdf.matches("<link name=").count(), urdf.matches("<joint name=").count() + 1, "one tree");
}
