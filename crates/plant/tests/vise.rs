//! Parts in the vise: upright, falling and machined.

use crate::rig::{self, PFIX, Rig, description};
use geometry::frame::{Frame, Vector, rotation_by, rotation_from_x_y};
use plant::{CellEvent, WorkstationAction, WorkstationError};

/// A bar upright in the vise: its middle in the fixture's frame, tilted by `lean` degrees about the ledge's front edge.
pub fn upright(position: Vector, lean: f64) -> Frame {
    let fixture = PFIX.to_frame().unwrap();
    let square = rotation_from_x_y(&Vector::x(), &Vector::y()).unwrap();
    let edge = Vector::new(0.0, 0.0, -3.25);
    let turn = rotation_by(&Vector::new(0.0, -lean.to_radians(), 0.0));
    fixture.compose(&Frame { position: edge + turn * (position - edge), rotation: turn * square })
}

fn put(rig: &mut Rig, frame: Frame) {
    rig.cell.workstation(&WorkstationAction::Put { part: "LINKBAR1_BH".into(), frame }).unwrap();
}

fn machine(rig: &mut Rig) -> Result<(), WorkstationError> {
    rig.cell.workstation(&WorkstationAction::Machine {
        from: "LINKBAR1_BH".into(),
        to: "LINKBAR1".into(),
        location: "PFIXTURE".into(),
    })
}

#[test]
fn bar_leaning_less_than_a_degree_stays_on_the_ledge() {
    for (lean, stands) in [(0.0, true), (0.6, true), (1.5, false), (3.0, false)] {
        let mut rig = Rig::new(&description(), 1);
        put(&mut rig, upright(Vector::new(0.0375, 0.16, -1.249), lean));
        rig.ticks(100);
        let part = rig.part();
        assert_eq!(
            part.location == "PFIXTURE",
            stands,
            "leaning by {lean} degrees: {part:?} {:?}",
            rig.in_fixture()
        );
        if stands {
            assert!((rig.in_fixture().position.z + 1.25).abs() < 0.004, "sinks: {:?}", rig.in_fixture());
        } else {
            assert!(part.position[2] < -15.0, "{part:?}");
        }
    }
}

#[test]
fn only_a_clamped_and_seated_part_is_machined() {
    let mut rig = Rig::new(&description(), 1);
    assert!(matches!(machine(&mut rig), Err(WorkstationError::NotClamped { .. })));

    // Not seated: 0.06 from the back of the notch and 0.15 above the ledge.
    put(&mut rig, upright(Vector::new(0.0375, 0.15, -1.2), 0.0));
    rig.cell.workstation(&WorkstationAction::ViseClose).unwrap();
    assert!(matches!(rig.cell.workstation(&WorkstationAction::ViseOpen), Err(WorkstationError::Busy)));
    while rig.cell.workstation_busy() {
        rig.tick();
    }
    assert!(rig.part().clamped);
    let error = machine(&mut rig).unwrap_err();
    assert!(matches!(error, WorkstationError::NotSeated { distance, .. } if distance > 0.05), "{error}");
    let id = rig.part().id;
    assert!(matches!(
        rig.cell.workstation(&WorkstationAction::Remove { id }),
        Err(WorkstationError::Held { .. })
    ));
    rig.vise(WorkstationAction::ViseOpen);
    rig.cell.workstation(&WorkstationAction::Remove { id }).unwrap();
    assert!(rig.cell.parts().is_empty());

    put(&mut rig, upright(Vector::new(0.096, 0.152, -1.249), 0.0));
    rig.vise(WorkstationAction::ViseClose);
    let wrong = WorkstationAction::Machine {
        from: "LINKBAR1".into(),
        to: "LINKBAR1_BH".into(),
        location: "PFIXTURE".into(),
    };
    assert!(matches!(rig.cell.workstation(&wrong), Err(WorkstationError::WrongPart { .. })));
    machine(&mut rig).unwrap();
    assert_eq!(rig.part().name, "LINKBAR1");
    rig.ticks(25);
    assert!(rig.part().error.unwrap() < 0.01, "{:?}", rig.part());
}

#[test]
fn machining_to_a_smaller_part_keeps_it_seated_and_clamped() {
    let text = rig::CELL.replace(
        "name = \"LINKBAR1\"\nsize = [0.625, 0.625, 4.00]",
        "name = \"LINKBAR1\"\nsize = [0.600, 0.550, 3.90]",
    );
    let mut rig = Rig::new(&plant::CellDescription::from_toml(&text).unwrap(), 1);
    put(&mut rig, upright(Vector::new(0.096, 0.152, -1.249), 0.0));
    rig.vise(WorkstationAction::ViseClose);
    machine(&mut rig).unwrap();
    rig.ticks(25);
    let part = rig.part();
    assert!(part.clamped && part.error.unwrap() < 0.01, "{part:?}");
    assert!((rig.cell.vise_opening() - 0.55).abs() < 1e-6, "{}", rig.cell.vise_opening());
}

#[test]
fn clamped_bar_resists_the_robot_push() {
    let mut rig = Rig::new(&description(), 1);
    put(&mut rig, upright(Vector::new(0.0375, 0.152, -1.249), 0.0));
    rig.vise(WorkstationAction::ViseClose);
    let before = rig.in_fixture().position;
    rig.go(rig::FIX_V1.to_frame().unwrap(), 10.0);
    rig.go(Rig::fixture(&rig::HOLD, 5.0, 0.0), 4.0);
    // 0.02 in into the bar: the arm deflects under 40 lb, the vise does not.
    rig.go_and_stop(Rig::fixture(&rig::HOLD, -0.095, 0.0), 0.5);
    let moved = (rig.in_fixture().position - before).norm();
    assert!(moved < 0.004, "{moved}");
    let given = rig.cell.tool().position.x - 68.0 + 0.35 - 0.095;
    assert!((given + 0.02).abs() < 0.006, "the tool stands {given} in behind the command");
    assert!(!rig.log.iter().any(|event| matches!(event, CellEvent::Contact(_))), "{:?}", rig.log);
}

#[test]
fn collision_forces_a_bar_out_of_the_vise() {
    let mut rig = Rig::new(&description(), 1);
    put(&mut rig, upright(Vector::new(0.0375, 0.152, -1.249), 0.0));
    rig.vise(WorkstationAction::ViseClose);
    rig.go(rig::FIX_V1.to_frame().unwrap(), 10.0);
    rig.go(Rig::fixture(&rig::HOLD, 5.0, 0.0), 4.0);
    rig.go_and_stop(Rig::fixture(&rig::HOLD, -0.30, 0.0), 0.5);
    let out = CellEvent::ForcedOut { part: "LINKBAR1_BH".into() };
    assert!(rig.log.contains(&out), "500 lb at 0.20 on two faces are 200 lb: {:?}", rig.log);
}

#[test]
fn body_at_rest_does_not_creep() {
    let mut rig = Rig::new(&description(), 1);
    put(&mut rig, upright(Vector::new(0.0375, 0.16, -1.249), 0.0));
    rig.ticks(50);
    let before = rig.in_fixture().position;
    rig.ticks(1500);
    let crept = (rig.in_fixture().position - before).norm();
    assert!(crept < 0.004, "{crept} in a minute on the ledge");
}

#[test]
fn stack_of_five_is_stable_and_hardly_sinks() {
    let mut rig = Rig::new(&description(), 1);
    let sector = description().tray("UNIT_1").unwrap().sector(4).unwrap();
    for layer in 0..5 {
        let up = Vector::new(-0.3125 - 0.626 * f64::from(layer), 0.0, 0.0);
        put(&mut rig, sector.shifted(up));
    }
    rig.ticks(1500);
    for (layer, part) in (0_u8..).zip(rig.cell.parts()) {
        let nominal = -16.55 + 0.3125 + 0.625 * f64::from(layer);
        let [_, _, z] = part.position;
        assert!((z - nominal).abs() < 0.004 * 5.0, "layer {layer} is {} in low", nominal - z);
        assert!(part.error.is_some_and(|error| error < 0.02), "{part:?}");
    }
}
