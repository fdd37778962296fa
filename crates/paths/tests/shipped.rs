//! Checks the shipped data: every path of every job is possible, and its clearances are as expected.

use std::{collections::BTreeSet, path::Path};

use paths::{
    job::{WalkedJob, walk_job},
    known::Known,
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
    walk_job(&job, &store, &room, &Known::default())
}

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
fn vise_and_back() {
    sound("vise-and-back");
}

#[test]
fn brush() {
    sound("brush");
}

#[test]
fn stored_routes() {
    let (store, _) = Store::load(data()).unwrap_or_else(|report| panic!("{report}"));
    let room = Room::new(&CellDescription::load(&data().join("cell.toml")).unwrap());
    let stored = walk_stored(&store, &room, &Known::default());
    assert!(stored.segments > 40, "{}", stored.segments);
    let texts: Vec<&str> = stored.findings.iter().map(|one| one.message.as_str()).collect();
    assert_eq!(texts, [""; 0]);
}

#[test]
fn a_held_part_moves_with_the_hand() {
    let walked = walked("linkbar");
    let held: Vec<Option<&str>> = walked.lines.iter().map(|line| line.holds.as_deref()).collect();
    let [blank, bar] = ["LINKBAR1_BH with grip +2", "LINKBAR1 with grip +2"].map(Some);
    assert_eq!(held, [blank, None, None, None, bar, None]);
    assert_eq!(walked.lines[0].tried, 13, "the part lies anywhere in its sector");
    // The least clearance is 0.04 in, on each side of the bar.
    let into = walked.lines[0].phases.last().and_then(|phase| phase.segments.last()).unwrap();
    let near = into.nearest.as_ref().unwrap();
    assert_eq!((near.mover.as_str(), near.obstacle.as_str()), ("LINKBAR1_BH", "fixed_jaw"));
    assert!((0.02..0.06).contains(&near.clearance_in), "{near:?}");
    assert!(walked.nearest().is_some_and(|near| near.clearance_in > -0.01));
}

/// The sectors that fit are those that `data/README.md` states for the linkbar job.
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
            let findings = walk_job(&job, &store, &room, &Known::default()).findings;
            assert!(findings.iter().all(|one| one.code == "path.contact"), "{unit} {sector}: {findings:?}");
            assert_eq!(findings.is_empty(), unit == "UNIT_1", "the fingers meet a pot in a corner of UNIT_2");
            if findings.iter().any(|one| one.error) {
                unfit.push((unit, sector));
            }
        }
    }
    assert_eq!(unfit, [("UNIT_2", 3), ("UNIT_2", 4)]);
}

/// Data loaded during a command apply to the next one.
#[test]
fn loaded_data_apply_to_later_lines() {
    let (store, _) = Store::load(data()).unwrap_or_else(|report| panic!("{report}"));
    let room = Room::new(&CellDescription::load(&data().join("cell.toml")).unwrap());
    let place = tempfile::tempdir().unwrap();
    // Inside the body of the vise, on the way to SAFE.
    let low = "BLOCK# 1 OFFSET 22000
   3950 -4400 -800
   6950 -4400 -800
   6950 -1400 -800  -pose- ... LOW
-traj  HOME-SAFE  lpt HOME  lpt SAFE
  -ppt  4 100 8 0  pos LOW
";
    std::fs::write(place.path().join("low.blk"), low).unwrap();
    let failing = |load: &str, before: bool| {
        let go = "== MOVE -- +0 -- 0 +0 SAFE 0 -- 0\n== MOVE -- +0 -- 0 +0 HOME 0 -- 0\n";
        let text = if before { format!("{load}\n{go}{go}") } else { format!("{go}{load}\n{go}") };
        let name = place.path().join("load.job").display().to_string();
        let (job, _) = Job::from_source(Source { name, text: text.into() }, &store)
            .unwrap_or_else(|report| panic!("{report}"));
        let walked = walk_job(&job, &store, &room, &Known::default());
        let errors = walked.findings.iter().filter(|one| one.error);
        (errors.map(|one| one.line).collect::<BTreeSet<u32>>(), walked.not_checked)
    };
    assert_eq!(failing("% nothing", true), (BTreeSet::new(), vec![]));
    assert_eq!(failing("** load low.blk", true), (BTreeSet::from([2, 4]), vec![]));
    assert_eq!(failing("** after 50 load low.blk", true), (BTreeSet::from([4]), vec![]));
    assert_eq!(failing("** load low.blk", false), (BTreeSet::from([4]), vec![]));
    let not_checked = "what comes after line 1: the loaded blocks do not fit the cell".to_owned();
    assert_eq!(failing("** load low.blk expect error", true), (BTreeSet::new(), vec![not_checked]));
}
