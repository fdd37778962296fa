//! The link survives each example of `data/faults` with faults of the line only.

#[path = "../../depc/tests/session/mod.rs"]
mod session;

use std::{fs, path::Path};

use diagnostics::Source;
use plant::fault::text::parse_line;
use session::Session;

#[test]
fn link_survives_every_example() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/faults");
    let mut examples = 0;
    for entry in fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        assert_eq!(path.extension().and_then(|e| e.to_str()), Some("toml"), "{}", path.display());
        let text = fs::read_to_string(&path).unwrap();
        let source = Source { name: path.display().to_string(), text: text.into() };
        // tests/faults.rs plays faults of the rest of the cell.
        let Ok(plan) = parse_line(&source) else { continue };
        let mut session = Session::new(1, &plan);
        for tick in 0..2000 {
            if tick % 60 == 0 {
                session.new_goal();
            }
            session.tick();
        }
        assert!(session.injector.total().faults() > 0, "{}: no fault in 2000 ticks", path.display());
        session.until_reached(400);
        examples += 1;
    }
    assert!(examples >= 7, "{examples} examples");
}
