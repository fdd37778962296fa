//! Looks up a place in a tray: `cargo run --release -p taskdata --example lookup`.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "an example prints what it does")]

use std::path::Path;

use rcs_core::name::Name16;
use taskdata::load::Store;

fn main() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
    let (store, report) = match Store::load(&data) {
        Ok(loaded) => loaded,
        Err(report) => return eprintln!("{report}"),
    };
    print!("{}", report.summary());
    let (unit, object) = (Name16::clipped("UNIT_1"), Name16::clipped("LINKBAR1_BH"));
    match store.view().resolve_location(&unit, Some(4), Some(&object)) {
        Ok(location) => println!("{object} in sector 4 of {unit}: {location:?}"),
        Err(error) => println!("{error}"),
    }
}
