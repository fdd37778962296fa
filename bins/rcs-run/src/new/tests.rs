use std::path::{Path, PathBuf};

use plant::CellDescription;
use taskdata::load::Store;

use super::{
    family::Family,
    part::{Made, Size, make},
    sizes::Sizes,
    trial::Trial,
};
use crate::error::Error;

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data")
}

fn loaded() -> (Store, CellDescription) {
    let (store, _) = Store::load(&data()).unwrap_or_else(|report| panic!("{report}"));
    (store, CellDescription::load(&data().join("cell.toml")).expect("it is sound"))
}

fn made(name: &str, size: &str, like: &str) -> Result<Made, Error> {
    let (store, cell) = loaded();
    let size: Size = size.parse().expect("it is a size");
    make(name, size, like, (&store, &cell, &data()))
}

/// Made, checked and run.
fn tried(name: &str, size: &str, like: &str) -> Result<usize, Error> {
    let made = made(name, size, like)?;
    Trial::checked(&made.change, name)?.run(&made.job, false)
}

fn refused(name: &str, size: &str, like: &str) -> String {
    made(name, size, like).err().map_or_else(|| panic!("{name} {size} is made"), |error| error.to_string())
}

#[test]
fn a_part_of_the_same_size_has_the_same_numbers() {
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
fn a_smaller_clevis_is_machined_on_both_sides() {
    // The vise gets a step for it.
    assert_eq!(tried("HINGE", "3x1.5x1", "LCLEVIS").map_err(|error| error.to_string()), Ok(3));
}

#[test]
fn a_longer_and_wider_linkbar_comes_back() {
    assert_eq!(tried("BAR", "5x0.8x0.625", "LINKBAR1").map_err(|error| error.to_string()), Ok(3));
}

#[test]
fn the_forms_move_with_the_size() {
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
fn a_tray_can_stand_elsewhere() {
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
    assert!(inside.err().is_some_and(|error| error.to_string().contains("would stand in UNIT_2")));
    let unknown = super::tray::make("UNIT_3", [0.0, 0.0], "UNIT_9", (&store, &cell, &data()));
    assert!(unknown.err().is_some_and(|error| error.to_string().contains("no tray is named UNIT_9")));
}

#[test]
fn what_cannot_be_says_why() {
    assert!(refused("LINKBAR1", "4x1x1", "LINKBAR1").contains("choose another name, such as LINKBAR12"));
    assert!(refused("hinge", "4x1x1", "LINKBAR1").contains("capital letters"));
    assert!(refused("NEW", "4x1x1", "LINKBAR3").contains("the nearest is LINKBAR1"));
    assert!(refused("NEW", "4x1x1", "SHAFT").contains("SHAFT_BH is no box"));
    assert!(refused("NEW", "3x1.5x1", "DRILL-2").contains("has several parts"));
    assert!(refused("NEW", "9x1x1", "LCLEVIS").contains("in of room around its middle"));
    assert!(refused("NEW", "4x4x1.73", "LCLEVIS").contains("the jaws open for parts up to"));
    for wrong in ["3x1.5", "3x1.5x0", "3x1.5x1x1", "axbxc", "3x1x30"] {
        assert!(wrong.parse::<Size>().is_err(), "{wrong}");
    }
}
