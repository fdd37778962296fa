//! Programs of the vise, nests, cylinders: workstation actions with parts of other shapes.

use crate::rig::{self, PFIX, Rig, description, table};
use geometry::{
    frame::{Frame, Vector, rotation_by, rotation_from_x_y},
    movetable::System,
};
use plant::{Placement, WorkstationAction, WorkstationError};

fn place(rig: &mut Rig, part: &str, unit: &str, sector: u16) -> Result<(), WorkstationError> {
    let placement = Placement::Random;
    let action = WorkstationAction::Place { part: part.into(), unit: unit.into(), sector, placement };
    rig.cell.workstation(&action)
}

fn put(rig: &mut Rig, part: &str, frame: Frame) {
    rig.cell.workstation(&WorkstationAction::Put { part: part.into(), frame }).unwrap();
}

fn machine(rig: &mut Rig, from: &str, to: &str, location: &str) -> Result<(), WorkstationError> {
    let action = WorkstationAction::Machine { from: from.into(), to: to.into(), location: location.into() };
    rig.cell.workstation(&action)
}

fn program(rig: &mut Rig, name: &str) -> Result<(), WorkstationError> {
    rig.cell.workstation(&WorkstationAction::ViseProgram { name: name.into() })
}

/// A clevis in the vise, X in, Y left, Z up, with its middle at a point of the fixture's frame.
fn clevis(position: Vector) -> Frame {
    let square = rotation_from_x_y(&Vector::x(), &Vector::y()).unwrap();
    PFIX.to_frame().unwrap().compose(&Frame { position, rotation: square })
}

#[test]
fn program_opens_the_vise_for_its_parts() {
    let mut rig = Rig::new(&description(), 1);
    assert!((rig.cell.vise_opening() - 0.80).abs() < 1e-9, "LINKBAR is on at the start");
    program(&mut rig, "CLEVIS").unwrap();
    rig.vise(WorkstationAction::ViseOpen);
    assert!((rig.cell.vise_opening() - 2.76).abs() < 1e-9, "{}", rig.cell.vise_opening());
    rig.vise(WorkstationAction::VisePartial);
    assert!((rig.cell.vise_opening() - 2.64).abs() < 1e-9, "{}", rig.cell.vise_opening());
    program(&mut rig, "LINKBAR").unwrap();
    rig.vise(WorkstationAction::VisePartial);
    assert!((rig.cell.vise_opening() - 0.705).abs() < 1e-9, "{}", rig.cell.vise_opening());
    let unknown = program(&mut rig, "CLEVI").unwrap_err();
    assert_eq!(
        unknown.to_string(),
        "the vise has no program CLEVI; the cell description has LINKBAR, CLEVIS"
    );
    rig.cell.workstation(&WorkstationAction::ViseOpen).unwrap();
    assert_eq!(program(&mut rig, "CLEVIS"), Err(WorkstationError::Busy));
}

#[test]
fn clevis_is_clamped_and_machined_in_its_step() {
    let mut rig = Rig::new(&description(), 1);
    program(&mut rig, "CLEVIS").unwrap();
    rig.vise(WorkstationAction::VisePartial);
    put(&mut rig, "LCLEVIS_BH", clevis(Vector::new(0.72, 1.22, 1.002)));
    rig.ticks(25);
    assert_eq!(rig.part().location, "PFIXTURE", "it stands on the ledge: {:?}", rig.part());
    rig.vise(WorkstationAction::ViseClose);
    assert!(rig.part().clamped && (rig.cell.vise_opening() - 2.56).abs() < 1e-3, "{:?}", rig.part());
    machine(&mut rig, "LCLEVIS_BH", "LCLEVIS_IH", "PFIXTURE").unwrap();
    rig.ticks(25);
    let seated = rig.in_fixture().position;
    assert!((seated - Vector::new(0.745, 1.18, 1.0)).norm() < 0.02, "0.05 off the front: {seated:?}");
    let part = rig.part();
    assert!(part.clamped && part.name == "LCLEVIS_IH" && part.error.unwrap() < 0.02, "{part:?}");
}

#[test]
fn clevis_away_from_the_back_is_not_machined() {
    let mut rig = Rig::new(&description(), 1);
    program(&mut rig, "CLEVIS").unwrap();
    rig.vise(WorkstationAction::VisePartial);
    put(&mut rig, "LCLEVIS_BH", clevis(Vector::new(0.66, 1.22, 1.002)));
    rig.vise(WorkstationAction::ViseClose);
    let error = machine(&mut rig, "LCLEVIS_BH", "LCLEVIS_IH", "PFIXTURE").unwrap_err();
    assert!(
        matches!(error, WorkstationError::NotSeated { distance, .. } if (0.06..0.09).contains(&distance))
    );
    assert!(error.to_string().ends_with("0.03 in and 1 degrees are allowed"), "{error}");
    let wrong = machine(&mut rig, "LCLEVIS_IH", "LCLEVIS", "PFIXTURE").unwrap_err();
    assert_eq!(wrong.to_string(), "LCLEVIS_IH is to be machined, but LCLEVIS_BH is there");
    let larger = machine(&mut rig, "LCLEVIS_BH", "SHAFT", "PFIXTURE").unwrap_err();
    assert_eq!(larger.to_string(), "SHAFT does not fit into LCLEVIS_BH");
    let nowhere = machine(&mut rig, "LCLEVIS_BH", "LCLEVIS_IH", "TABLE").unwrap_err();
    assert_eq!(
        nowhere.to_string(),
        "nothing can be machined at TABLE; the cell description has machines at PFIXTURE, V-VFIXTURE"
    );
}

#[test]
fn bar_stops_the_jaw_in_every_program() {
    let mut rig = Rig::new(&description(), 1);
    put(&mut rig, "LINKBAR1_BH", clevis(Vector::new(0.096, 0.152, -1.249)));
    program(&mut rig, "CLEVIS").unwrap();
    rig.vise(WorkstationAction::ViseClose);
    assert!(rig.part().clamped, "{:?}", rig.part());
    assert!((rig.cell.vise_opening() - 0.50).abs() < 1e-3, "{}", rig.cell.vise_opening());
}

#[test]
fn cylinder_is_at_rest_in_cradle_and_nest() {
    let mut rig = Rig::new(&description(), 1);
    place(&mut rig, "SHAFT_BH", "UNIT_2", 7).unwrap();
    place(&mut rig, "SHAFT", "UNIT_2", 8).unwrap();
    place(&mut rig, "SHAFT_BH", "V-VFIXTURE", 0).unwrap();
    for sector in 1..=3 {
        place(&mut rig, "ENDMILL-1", "UNIT_2", sector).unwrap();
    }
    rig.ticks(100);
    let before: Vec<Frame> = (1..=6).map(|id| rig.cell.part_frame(id).unwrap()).collect();
    rig.ticks(1500);
    for (id, before) in (1..=6).zip(&before) {
        let after = rig.cell.part_frame(id).unwrap();
        let crept = (after.position - before.position).norm();
        assert!(crept < 0.004, "part {id} creeps by {crept} in a minute");
    }
    let places: Vec<_> = rig.cell.parts().into_iter().map(|part| (part.location, part.sector)).collect();
    let unit = |sector: u16| ("UNIT_2".to_owned(), sector);
    assert_eq!(places, [unit(7), unit(8), ("V-VFIXTURE".into(), 0), unit(1), unit(2), unit(3)]);
    let errors: Vec<f64> = rig.cell.parts().into_iter().filter_map(|part| part.error).collect();
    // The thinner shaft lies 0.05 in lower; tools lean against the wall of their pot.
    assert!(errors.len() == 6 && errors.iter().all(|error| *error < 0.12), "{errors:?}");
}

#[test]
fn shaft_is_machined_in_its_nest() {
    let mut rig = Rig::new(&description(), 1);
    let empty = machine(&mut rig, "SHAFT_BH", "SHAFT", "V-VFIXTURE").unwrap_err();
    assert_eq!(empty.to_string(), "SHAFT_BH is to be machined, but nothing is at V-VFIXTURE");
    place(&mut rig, "SHAFT_BH", "V-VFIXTURE", 0).unwrap();
    rig.ticks(25);
    machine(&mut rig, "SHAFT_BH", "SHAFT", "V-VFIXTURE").unwrap();
    rig.ticks(50);
    let part = rig.part();
    assert!(part.name == "SHAFT" && part.location == "V-VFIXTURE", "{part:?}");
    assert!(part.error.unwrap() < 0.05, "it stands where it stood: {part:?}");
}

#[test]
fn leaning_part_in_its_nest_is_not_machined() {
    let mut rig = Rig::new(&description(), 1);
    let upright = rotation_from_x_y(&Vector::x(), &Vector::y()).unwrap();
    let lean = rotation_by(&Vector::new(0.0, 0.07, 0.0));
    let frame = Frame { position: Vector::new(69.61, -56.0, -2.40), rotation: lean * upright };
    put(&mut rig, "SHAFT_BH", frame);
    let error = machine(&mut rig, "SHAFT_BH", "SHAFT", "V-VFIXTURE").unwrap_err();
    assert!(matches!(error, WorkstationError::NotSeated { degrees, .. } if degrees > 3.5), "{error}");
}

#[test]
fn part_with_nests_is_accepted_only_there() {
    let mut rig = Rig::new(&description(), 1);
    let nowhere = place(&mut rig, "SHAFT_BH", "UNIT_1", 4).unwrap_err();
    let text = "no place for SHAFT_BH in sector 4 of UNIT_1; the cell description has UNIT_2 7, UNIT_2 8, V-VFIXTURE";
    assert_eq!(nowhere.to_string(), text);
    place(&mut rig, "SHAFT_BH", "UNIT_2", 7).unwrap();
    let occupied = place(&mut rig, "SHAFT_BH", "UNIT_2", 7).unwrap_err();
    assert_eq!(occupied.to_string(), "SHAFT_BH cannot be put there: SHAFT_BH is in the way");
}

#[test]
fn fingers_lift_a_cylinder_out_of_its_cradle() {
    let mut rig = Rig::new(&description(), 1);
    place(&mut rig, "SHAFT_BH", "UNIT_2", 7).unwrap();
    rig.ticks(10);
    let sector = Frame {
        position: Vector::new(-48.50, -26.45, -15.17),
        rotation: rotation_from_x_y(&-Vector::z(), &Vector::x()).unwrap(),
    };
    let grip = table(&[(System::Tool, [60, 0, 0]), (System::ToolOrigin, [-300, 0, 0])]).apply(&sector);
    rig.go(rig::UNIT_V1.to_frame().unwrap(), 10.0);
    rig.open(3.0);
    rig.go(grip.shifted(Vector::new(-8.0, 0.0, 0.0)), 10.0);
    rig.go_and_stop(grip, 4.0);
    rig.close(40.0);
    assert!((rig.cell.fingers().0 - 1.5).abs() < 0.001, "{:?}", rig.cell.fingers());
    rig.go_and_stop(grip.shifted(Vector::new(-5.0, 0.0, 0.0)), 4.0);
    let part = rig.part();
    assert!(part.held && part.position[2] > -11.0, "{part:?} {:?}", rig.log);
    assert!(rig.log.is_empty(), "{:?}", rig.log);
}

#[test]
fn cylinders_are_drawn_as_cylinders() {
    let mut rig = Rig::new(&description(), 1);
    place(&mut rig, "SHAFT_BH", "UNIT_2", 7).unwrap();
    let urdf = rig.cell.scene(&["ENDMILL-1", "LCLEVIS_BH"]).urdf();
    let part = |id: u32| {
        let start = urdf.find(&format!("<link name=\"part_{id}\">")).unwrap();
        urdf[start..].lines().nth(1).unwrap().to_owned()
    };
    assert!(
        part(1).contains("<cylinder radius=\"0.0190") && part(1).contains("length=\"0.1016"),
        "{}",
        part(1)
    );
    assert!(part(2).contains("<cylinder"), "{}", part(2));
    assert!(part(3).contains("<box"), "{}", part(3));
}
