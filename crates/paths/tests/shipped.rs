//! The shipped data: every way of every job can be flown, and passes what it must.

use std::path::Path;

use paths::{
    job::{WalkedJob, walk_job},
    stored::walk_stored,
};
use plant::{CellDescription, room::Room};
use taskdata::load::{Job, Source, Store};

fn data() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"))
}

fn walked(job: &str) -> WalkedJob {
    let (store, _) = Store::load(data()).unwrap_or_else(|report| panic!("{report}"));
    let (job, _) = Job::load(&data().join("jobs").join(format!("{job}.job")), &store)
        .unwrap_or_else(|report| panic!("{report}"));
    let room = Room::new(&CellDescription::load(&data().join("cell.toml")).unwrap());
    walk_job(&job, &store, &room)
}

/// No findings, and all lines walked.
fn sound(job: &str) {
    let walked = walked(job);
    let said: Vec<&str> = walked.findings.iter().map(|one| one.message.as_str()).collect();
    assert_eq!(said, [""; 0]);
    assert!(walked.not_checked.is_empty(), "{:?}", walked.not_checked);
    assert!(walked.lines.iter().flat_map(|line| &line.phases).all(|phase| phase.plan.missing.is_none()));
}

#[test]
fn linkbar() {
    sound("linkbar");
}

#[test]
fn clevis() {
    sound("clevis");
}

#[test]
fn turned_part() {
    sound("turned-part");
}

#[test]
fn tool_change() {
    sound("tool-change");
}

#[test]
fn stored_routes() {
    let (store, _) = Store::load(data()).unwrap_or_else(|report| panic!("{report}"));
    let room = Room::new(&CellDescription::load(&data().join("cell.toml")).unwrap());
    let stored = walk_stored(&store, &room);
    assert!(stored.segments > 40, "{}", stored.segments);
    let texts: Vec<&str> = stored.findings.iter().map(|one| one.message.as_str()).collect();
    assert_eq!(texts, [""; 0]);
}

/// What is carried along: the bar from the tray to the vise, through the hands of the workstation, and back.
#[test]
fn what_is_held_is_carried_along() {
    let walked = walked("linkbar");
    let held: Vec<Option<&str>> = walked.lines.iter().map(|line| line.holds.as_deref()).collect();
    let [blank, bar] = ["LINKBAR1_BH with grip +2", "LINKBAR1 with grip +2"].map(Some);
    assert_eq!(held, [blank, None, None, None, bar, None]);
    assert_eq!(walked.lines[0].tried, 13, "the part lies anywhere in its sector");
    // The bar goes between the jaws with 0.04 in on each side, and its held body is what is nearest there.
    let into = walked.lines[0].phases.last().and_then(|phase| phase.segments.last()).unwrap();
    let near = into.nearest.as_ref().unwrap();
    assert_eq!((near.mover.as_str(), near.obstacle.as_str()), ("LINKBAR1_BH", "fixed_jaw"));
    assert!((0.02..0.06).contains(&near.clearance_in), "{near:?}");
    assert!(walked.nearest().is_some_and(|near| near.clearance_in > -0.01));
}

/// The linkbar out of each sector: what `data/README.md` says of them.
#[test]
fn each_sector_is_fit_or_not() {
    let (store, _) = Store::load(data()).unwrap_or_else(|report| panic!("{report}"));
    let room = Room::new(&CellDescription::load(&data().join("cell.toml")).unwrap());
    let text = std::fs::read_to_string(data().join("jobs/linkbar.job")).unwrap();
    let mut unfit = Vec::new();
    for unit in ["UNIT_1", "UNIT_2"] {
        for sector in 1..=4 {
            let text = text.replace("UNIT_1 4", &format!("{unit} {sector}"));
            let source = Source { name: "linkbar.job".into(), text: text.into() };
            let (job, _) = Job::from_source(source, &store).unwrap_or_else(|report| panic!("{report}"));
            let findings = walk_job(&job, &store, &room).findings;
            assert!(findings.iter().all(|one| one.code == "path.contact"), "{unit} {sector}: {findings:?}");
            assert_eq!(findings.is_empty(), unit == "UNIT_1", "the fingers meet a pot in a corner of UNIT_2");
            if findings.iter().any(|one| one.error) {
                unfit.push((unit, sector));
            }
        }
    }
    assert_eq!(unfit, [("UNIT_2", 3), ("UNIT_2", 4)]);
}
