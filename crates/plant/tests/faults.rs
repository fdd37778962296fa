//! Faults in the cell, with arm and valves driven directly: their effects and limits.

use crate::rig::{Rig, description};
use diagnostics::Source;
use interfaces::device::{DeviceOutputs, VisionStatus};
use plant::{
    Cell, CellEvent, Placement, WorkstationAction,
    fault::{FaultPlan, text::parse},
};

fn plan(text: &str) -> FaultPlan {
    let source = Source { name: "faults.toml".to_owned(), text: text.into() };
    parse(&source, &description()).unwrap().cell
}

fn cell(text: &str) -> Cell {
    Cell::with_faults(&description(), 1, &plan(text)).unwrap()
}

fn ticks(cell: &mut Cell, outputs: &DeviceOutputs, count: u32) {
    for _ in 0..count {
        cell.step(outputs);
    }
}

fn deliver(cell: &mut Cell, part: &str) -> Result<(), plant::WorkstationError> {
    let placement = Placement::At { x: 0.0, y: 0.0, angle: 0.0 };
    let (part, unit) = (part.into(), "UNIT_1".into());
    cell.workstation(&WorkstationAction::Place { part, unit, sector: 4, placement })
}

#[test]
fn lost_air_keeps_the_grip_closed() {
    let mut rig = Rig::with_faults(&description(), 1, &plan("[[fault]]\nkind = \"air-lost\"\nfrom = 1500\n"));
    rig.place("LINKBAR1_BH", 4, 0.0, 0.0, 0.0);
    rig.pick(0.0, 0.0, 0.0, 30.0);
    assert!(rig.count < 1500, "{} ticks", rig.count);
    while rig.count < 1500 {
        rig.tick();
    }
    let force = rig.cell.fingers().1;
    rig.outputs.grip.bits = interfaces::device::valve::SUPPLY | interfaces::device::valve::OPEN_COARSE;
    rig.ticks(1500);
    assert_eq!(rig.cell.fingers().1, force, "trapped air");
    assert!(rig.part().held);
    assert!(rig.log.contains(&CellEvent::FaultBegins { number: 1, text: "the air is lost".into() }));
}

#[test]
fn fault_begins_and_ends_as_planned() {
    let mut cell = cell(
        "[[fault]]\nkind = \"off\"\nsensor = \"resolvers\"\nfrom = 3\nuntil = 6\n\
         [[fault]]\nkind = \"stuck\"\nsensor = \"quick-change.id\"\nvalue = 2\n",
    );
    assert_eq!(cell.inputs().quick_change.end_effector_id, 2, "from before the first tick");
    let valid: Vec<bool> = (0..7).map(|_| cell.step(&DeviceOutputs::default()).resolvers.valid).collect();
    assert_eq!(valid, [true, true, false, false, false, true, true]);
    let text = || "resolvers is off".to_owned();
    let events: Vec<CellEvent> = cell.events();
    assert!(events.contains(&CellEvent::FaultBegins { number: 1, text: text() }), "{events:?}");
    assert!(events.contains(&CellEvent::FaultEnds { number: 1, text: text() }), "{events:?}");
    let struck: Vec<(u64, u64, u64)> = cell.faults().iter().map(|s| (s.times, s.first, s.last)).collect();
    assert_eq!(struck, [(1, 3, 5), (1, 0, 7)]);
}

#[test]
fn deliveries_go_wrong_as_planned() {
    let mut none = cell("[[fault]]\nkind = \"missing\"\n");
    deliver(&mut none, "LINKBAR1_BH").unwrap();
    assert_eq!(none.parts(), []);
    let mut other = cell("[[fault]]\nkind = \"wrong-part\"\npart = \"LCLEVIS_BH\"\n");
    deliver(&mut other, "LINKBAR1_BH").unwrap();
    ticks(&mut other, &DeviceOutputs::default(), 20);
    let [part] = &other.parts()[..] else { panic!("one part") };
    assert_eq!((part.name.as_str(), part.location.as_str(), part.sector), ("LCLEVIS_BH", "UNIT_1", 4));
    assert!((part.position[2] - (-16.55 + 1.73 / 2.0)).abs() < 0.01, "it lies on the floor: {part:?}");
    let text =
        "[[fault]]\nkind = \"misplaced\"\nx = 1.0\ny = -0.5\n[[fault]]\nkind = \"turned\"\nangle = 30\n";
    let (mut right, mut wrong) = (cell("[[fault]]\nkind = \"camera-blind\"\n"), cell(text));
    deliver(&mut right, "LINKBAR1_BH").unwrap();
    deliver(&mut wrong, "LINKBAR1_BH").unwrap();
    let [a, b] = [&right, &wrong].map(|cell| cell.part_frame(1).unwrap());
    let away = b.position - a.position;
    assert!((away - geometry::frame::Vector::new(1.0, -0.5, 0.0)).norm() < 1e-9, "{away:?}");
    assert!((a.z().dot(&b.z()) - 30_f64.to_radians().cos()).abs() < 1e-9);
}

#[test]
fn a_stuck_vise_is_reported() {
    let mut cell = cell("[[fault]]\nkind = \"stuck\"\ndevice = \"vise-jaw\"\n");
    let before = cell.vise_opening();
    cell.workstation(&WorkstationAction::VisePartial).unwrap();
    let mut events = Vec::new();
    for _ in 0..60 {
        cell.step(&DeviceOutputs::default());
        events.extend(cell.events());
    }
    assert_eq!(cell.vise_opening(), before);
    assert_eq!(events.iter().filter(|event| **event == CellEvent::ViseStuck).count(), 1);
}

#[test]
fn moved_pedestal_carries_its_stand_and_hand() {
    let moved = cell("[[fault]]\nkind = \"pedestal-moved\"\nx = 0.5\ny = -0.25\nangle = 2\n");
    let there = Cell::new(&description(), 1).unwrap().pedestal();
    let away = moved.pedestal().position - there.position;
    assert!((away - geometry::frame::Vector::new(0.5, -0.25, 0.0)).norm() < 1e-9);
    let turned = there.y().dot(&moved.pedestal().y()).acos().to_degrees();
    assert!((turned - 2.0).abs() < 1e-6, "{turned}");
}

#[test]
fn camera_without_power_is_silent_and_blind_camera_finds_no_part() {
    let ask = |text: &str| {
        let mut cell = cell(text);
        let mut outputs = DeviceOutputs::default();
        outputs.vision.number = 1;
        outputs.vision.picture = interfaces::device::Picture::FastFlood;
        ticks(&mut cell, &outputs, 20);
        cell.inputs().vision
    };
    let silent = ask("[[fault]]\nkind = \"off\"\nsensor = \"camera\"\n");
    assert_eq!((silent.echo, silent.status), (0, VisionStatus::Idle));
    let blind = ask("[[fault]]\nkind = \"camera-blind\"\n");
    assert_eq!((blind.echo, blind.status), (1, VisionStatus::NothingSeen));
}

#[test]
fn restored_cell_keeps_its_faults() {
    let text = "[[fault]]\nkind = \"pedestal-moved\"\nx = 0.5\n\
        [[fault]]\nkind = \"intermittent\"\nsensor = \"beam.1\"\nrate = 0.2\n\
        [[fault]]\nkind = \"slow\"\nsensor = \"grip.potentiometer\"\nby = 4\n";
    let mut cell = cell(text);
    let mut outputs = DeviceOutputs::default();
    outputs.grip.bits = interfaces::device::valve::SUPPLY | interfaces::device::valve::OPEN_FINE;
    ticks(&mut cell, &outputs, 50);
    let mut restored = Cell::restore(&description(), &cell.save().unwrap()).unwrap();
    for _ in 0..100 {
        assert_eq!(cell.step(&outputs), restored.step(&outputs));
        assert_eq!(cell.digest(), restored.digest());
    }
    assert_eq!(cell.events(), restored.events());
    assert_eq!(cell.faults(), restored.faults());
}

fn shown(seed: u64) -> String {
    let text = "seed = 5\n\
        [[fault]]\nkind = \"noisy\"\nsensor = \"grip.potentiometer\"\nby = 20\n\
        [[fault]]\nkind = \"intermittent\"\nsensor = \"quick-change.locked\"\nrate = 0.1\nticks = 3\n";
    let mut cell = Cell::with_faults(&description(), seed, &plan(text)).unwrap();
    let inputs = (0..200).map(|_| format!("{:?}", cell.step(&DeviceOutputs::default())));
    inputs.collect::<Vec<_>>().join("\n")
}

#[test]
fn equal_seeds_give_equal_cell_faults() {
    let first = shown(1);
    assert_eq!(first, shown(1));
    assert_ne!(first, shown(2));
}
