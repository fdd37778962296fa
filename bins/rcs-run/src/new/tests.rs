use std::path::{Path, PathBuf};

use plant::CellDescription;
use taskdata::load::Store;

use super::{
    family::Family,
    part::{Made, Order, make},
    size::Size,
    sizes::Sizes,
    trial::Trial,
};
use crate::rcs_run::error::Error;

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../data")
}

fn loaded() -> (Store, CellDescription) {
    let (store, _) = Store::load(&data()).unwrap_or_else(|report| panic!("{report}"));
    (store, CellDescription::load(&data().join("cell.toml")).expect("it is sound"))
}

fn made(name: &str, size: &str, like: &str) -> Result<Made, Error> {
    let (store, cell) = loaded();
    let tool = cell.part(like).is_some_and(|part| part.tool);
    let size = (!size.is_empty()).then(|| size.parse().expect("it is a size"));
    make(&Order { name, like, tool, size, weight: None }, (&store, &cell, &data()))
}

fn tried(name: &str, size: &str, like: &str) -> Result<usize, Error> {
    let made = made(name, size, like)?;
    let trial = Trial::checked(&made.trial, name)?;
    made.jobs.iter().map(|job| trial.run(job, false)).sum()
}

fn refused(name: &str, size: &str, like: &str) -> String {
    made(name, size, like).err().map_or_else(|| panic!("{name} {size} is made"), |error| error.to_string())
}

#[test]
fn part_of_the_same_size_has_the_same_numbers() {
    let (store, cell) = loaded();
    for like in ["LINKBAR1", "LCLEVIS"] {
        let family = Family::of(like, &store, &cell, &data()).expect("it has a job");
        let blank = family.parts.first().expect("it has a blank").size;
        let sizes = Sizes::new(&cell, &family, "NEW", blank).expect("it fits");
        assert!(!sizes.step.is_new);
        for grip in family.grips() {
            let table = family.movetable(grip.movetable.name.as_str()).expect("it is there");
            let lines = sizes.moved(grip).expect("its place is known");
            assert_eq!(lines, table.lines, "{} of {}", table.name.name, grip.object.name);
        }
        let program = family.program.as_ref().expect("it has a vise");
        assert_eq!(sizes.step.program.opening_open, program.opening_open);
        assert_eq!(sizes.step.program.opening_partial, program.opening_partial);
    }
}

#[test]
fn smaller_clevis_is_machined_on_both_sides() {
    // The part gets a new step of the vise.
    assert_eq!(tried("HINGE", "3x1.5x1", "LCLEVIS").map_err(|error| error.to_string()), Ok(3));
}

#[test]
fn longer_and_wider_linkbar_round_trips() {
    assert_eq!(tried("BAR", "5x0.8x0.625", "LINKBAR1").map_err(|error| error.to_string()), Ok(3));
}

#[test]
fn thicker_and_longer_shaft_is_turned() {
    assert_eq!(tried("PIN", "5x1.55", "SHAFT").map_err(|error| error.to_string()), Ok(3));
}

#[test]
fn longer_tool_enters_and_leaves_the_drum() {
    assert_eq!(tried("REAMER-3", "4x1.75", "DRILL-2").map_err(|error| error.to_string()), Ok(6));
}

#[test]
fn parts_in_nests_move_with_their_centre() {
    let diff =
        |name, size, like| made(name, size, like).map(|made| made.change.diff()).expect("it can be made");
    // Another tool in the same holder is held at the same place as the like one.
    let tool = diff("TAP-4", "", "DRILL-2");
    for line in [
        "+  -obj- TAP-4 1 400 175 80 400",
        "+  -grip- TAP-4 1 $$$ ...",
        "+size = [3.3, 1.75, 1.75]",
        "+** drum tool TAP-4",
    ] {
        assert!(tool.lines().any(|found| found == line), "{line} is not in\n{tool}");
    }
    assert!(!tool.contains("-mtb- TAP"));
    let round = diff("PIN", "5x1.5", "SHAFT");
    for line in [
        "+  -grip- PIN_BH 1  lpt V-VFIXTURE PIN-2",
        "+  1 t 210 0 205 ----",
        "+seat = { wrist = [3950, -5600, -200], tool = [6950, -5600, -200], finger = [6950, -2600, -200] }",
        "+machining = { inches = 0.12, degrees = 3.0 }",
    ] {
        assert!(round.lines().any(|found| found == line), "{line} is not in\n{round}");
    }
}

#[test]
fn form_positions_follow_the_size() {
    let made = made("HINGE", "3x1.5x1", "LCLEVIS").expect("it can be made");
    let diff = made.change.diff();
    for line in [
        "+  -obj- HINGE_BH   2  394 144 35 264",
        "+size = [1.0, 1.5, 3.0]",
        "+size = [0.95, 1.5, 3.0]",
        "+ledge = -0.6",
        "+** vise partial PFIXTURE HINGE",
        "+== REFIXTURE HINGE_IH +1 PFIXTURE 0 -1 PFIXTURE 0 -- 0",
        "+  501 load ( hinge            )",
    ] {
        assert!(diff.lines().any(|found| found == line), "{line} is not in\n{diff}");
    }
}

#[test]
fn tray_at_another_point_passes_its_trial() {
    let (store, cell) = loaded();
    let made = super::tray::make("UNIT_3", [-40.0, -45.0], "UNIT_1", (&store, &cell, &data()));
    let diff = made.expect("it can be made").change.diff();
    for line in [
        "+centre = [-40.0, -45.0]",
        "+  -pt- UNIT_3 UNIT_3-P ...",
        "+  -5050 -5550 -1400",
        "+                        -m-   lpt        UNIT_3",
        "+  -vu- LINKBAR1_BH 2 17 lpt UNIT_3 GR-PIC lpt 590 1",
    ] {
        assert!(diff.lines().any(|found| found == line), "{line} is not in\n{diff}");
    }
    let inside = super::tray::make("UNIT_3", [-50.0, -10.0], "UNIT_1", (&store, &cell, &data()));
    assert!(inside.err().is_some_and(|error| error.to_string().contains("would overlap UNIT_2")));
    let unknown = super::tray::make("UNIT_3", [0.0, 0.0], "UNIT_9", (&store, &cell, &data()));
    assert!(unknown.err().is_some_and(|error| error.to_string().contains("no tray is named UNIT_9")));
}

#[test]
fn impossible_request_is_refused_with_the_reason() {
    assert!(refused("LINKBAR1", "4x1x1", "LINKBAR1").contains("choose another name, such as LINKBAR12"));
    assert!(refused("hinge", "4x1x1", "LINKBAR1").contains("capital letters"));
    assert!(refused("NEW", "4x1x1", "LINKBAR3").contains("the nearest is LINKBAR1"));
    assert!(refused("NEW", "4x1x1", "SHAFT").contains("SHAFT_BH is a cylinder: length x diameter was"));
    assert!(refused("NEW", "4x1", "LCLEVIS").contains("LCLEVIS_BH is a box"));
    assert!(refused("NEW", "4x1.8", "SHAFT").contains("into the nest at"));
    assert!(refused("NEW", "12x1.5", "SHAFT").contains("into the nest at"));
    assert!(refused("NEW", "4x3.4", "SHAFT").contains("takes diameters from 0.50 to 3.00 in"));
    assert!(refused("NEW", "3.3x2.2", "DRILL-2").contains("into the nest at UNIT_2 sector 1"));
    assert!(refused("DRILL-2", "", "ENDMILL-1").contains("choose another name, such as DRILL-22"));
    assert!(refused("NEW", "9x1x1", "LCLEVIS").contains("in of room around its middle"));
    assert!(refused("NEW", "4x4x1.73", "LCLEVIS").contains("the jaws open for parts up to"));
    for wrong in ["3", "3x1.5x0", "3x1.5x1x1", "axbxc", "3x1x30"] {
        assert!(wrong.parse::<Size>().is_err(), "{wrong}");
    }
}
