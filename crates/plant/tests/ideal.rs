//! The ideal cell accepts and refuses the same actions of a workstation as the cell.

use crate::{rig::description, vise::upright};
use geometry::frame::Vector;
use plant::{Cell, Ideal, Key, Placement, TableKey, WorkstationAction as Action, room::Room};

fn both(actions: &[Action]) -> Vec<Result<(), String>> {
    let description = &description();
    let mut cell = Cell::new(description, 1).expect("the cell is sound");
    let mut ideal = Ideal::new(&Room::new(description), 1).expect("the cell is sound");
    let mut results = Vec::new();
    for action in actions {
        let expected = cell.workstation(action).map_err(|error| error.to_string());
        while cell.workstation_busy() {
            cell.step(&Default::default());
        }
        let found = ideal.workstation(action).map_err(|error| error.to_string());
        assert_eq!(found, expected, "{action:?}");
        results.push(found);
    }
    results
}

fn place(part: &str, sector: u16) -> Action {
    let placement = Placement::At { x: 0.0, y: 0.0, angle: 0.0 };
    Action::Place { part: part.into(), unit: "UNIT_1".into(), sector, placement }
}

fn machine(from: &str, to: &str) -> Action {
    Action::Machine { from: from.into(), to: to.into(), location: "PFIXTURE".into() }
}

#[test]
fn ideal_cell_and_cell_refuse_the_same_actions() {
    let actions = [
        place("LINKBAR1_BH", 4),
        place("LINKBAR1_BH", 4),
        place("LINKBAR1_BH", 99),
        place("NOTHING", 1),
        machine("LINKBAR1_BH", "LINKBAR1"),
        Action::DrumGrip,
        Action::DrumTool { part: "LINKBAR1_BH".into() },
        Action::DrumTool { part: "DRILL-2".into() },
        Action::DrumTool { part: "DRILL-2".into() },
        Action::DrumRelease,
        Action::DrumGrip,
        Action::ViseProgram { name: "NONE".into() },
        Action::T3(Key::Auto),
        Action::Table(TableKey::Run { plus: true, ticks: 3 }),
        Action::ViseClose,
    ];
    let results = both(&actions);
    let accepted: Vec<_> =
        results.iter().enumerate().filter(|(_, one)| one.is_ok()).map(|(at, _)| at).collect();
    assert_eq!(accepted, [0, 7, 9, 10, 14], "{results:#?}");
}

#[test]
fn only_the_expected_part_in_the_jaws_is_machined() {
    let frame = upright(Vector::new(0.096, 0.16, -1.249), 0.0);
    let actions = [
        Action::Put { part: "LINKBAR1_BH".into(), frame },
        Action::ViseClose,
        machine("LCLEVIS_BH", "LCLEVIS_IH"),
        machine("LINKBAR1_BH", "LINKBAR1"),
        machine("LINKBAR1_BH", "LINKBAR1"),
        Action::ViseOpen,
        machine("LINKBAR1", "LINKBAR1"),
    ];
    let accepted: Vec<_> = both(&actions).iter().map(Result::is_ok).collect();
    assert_eq!(accepted, [true, true, false, true, false, true, false]);
}
