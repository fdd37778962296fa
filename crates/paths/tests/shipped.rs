//! The shipped data: every way of every job can be flown, and passes what it must.

use std::path::Path;

use paths::{
    job::{WalkedJob, walk_job},
    stored::walk_stored,
};
use plant::{CellDescription, room::Room};
use taskdata::load::{Job, Store};

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
    let started = std::time::Instant::now();
    let walked = walked(job);
    println!("{job}: {:?}", started.elapsed());
    for line in &walked.lines {
        println!("{} {} (tried {}) holds {:?}", line.line, line.text, line.tried, line.holds);
        for phase in &line.phases {
            println!("  {} {}", phase.plan.what, phase.plan.missing.as_deref().unwrap_or_default());
            for segment in &phase.segments {
                let near = segment.nearest.as_ref().map_or(String::new(), ToString::to_string);
                println!(
                    "     {} {} {} {:.2} {near}",
                    segment.from, segment.to, segment.joint, segment.margin_deg
                );
            }
        }
    }
    for finding in &walked.findings {
        println!("{finding:?}");
    }
    assert!(walked.findings.is_empty());
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
    let started = std::time::Instant::now();
    let stored = walk_stored(&store, &room);
    println!("{} segments in {:?}", stored.segments, started.elapsed());
    let texts: Vec<&str> = stored.findings.iter().map(|one| one.message.as_str()).collect();
    assert_eq!(texts, [""; 0]);
}
