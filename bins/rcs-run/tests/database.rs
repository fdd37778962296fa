//! The Data System of a run: items in a file that remains after the run, and that other programs can read.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
    thread,
    time::Duration,
};

use neighbours::data_system::{Item, Records as _};
use serde_json::Value;
use sessions::data_system::Store;

const CONNECT: &str = "== STARTUP -- +0 -- 0 +0 -- 0 -- 0\n";
const FETCH: &str = "** tray UNIT_1 4 LINKBAR1_BH\n\
                     ** vise partial PFIXTURE LINKBAR\n\
                     == MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE 0 -- 0 #17\n";

struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, job: &str, more: &[&str]) -> Command {
        let path = self.file("try.job");
        fs::write(&path, job).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_rcs-run"));
        command
            .arg(path)
            .args(["--json", "--log", "none", "--shared-memory", "off", "--database"])
            .arg(self.file("items.db"))
            .args(more)
            .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
            .stdin(Stdio::null());
        command
    }

    fn run(&self, job: &str) -> Output {
        self.command(job, &[]).output().unwrap()
    }

    fn items(&self) -> Vec<Item> {
        Store::open(&self.file("items.db")).unwrap().items().unwrap()
    }
}

/// The blank of [`FETCH`]: it is in the vise, and the robot still holds it.
fn in_hand() -> Item {
    Item {
        number: "17".into(),
        name: "LINKBAR1_BH".into(),
        kind: "PART".into(),
        device: "H_ROBOT".into(),
        position: "H_ROBOT".into(),
        sector: 0,
    }
}

#[test]
fn item_file_has_the_place_of_every_part() {
    let place = Place::new();
    let output = place.run(&format!("{CONNECT}{FETCH}"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let result: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(result["data_base"][0]["serial"], "17");
    assert_eq!(place.items(), [in_hand()]);
    assert!(!place.file("items.db-wal").exists(), "the journal is taken into the file at the end");
}

#[test]
fn without_startup_no_update_is_sent() {
    let place = Place::new();
    assert!(place.run(FETCH).status.success());
    assert!(place.items().is_empty());
}

#[test]
fn sent_updates_survive_a_killed_run() {
    let place = Place::new();
    // More than an hour of waiting: some seconds in fast clock.
    let job = format!("{CONNECT}{FETCH}{}", "** wait 36000\n".repeat(100));
    let mut run = place.command(&job, &[]).stdout(Stdio::null()).spawn().unwrap();
    for _ in 0..600 {
        thread::sleep(Duration::from_millis(100));
        // Before the run has made the journal, queries have no answer.
        if place.file("items.db-wal").exists()
            && Store::open(&place.file("items.db"))
                .is_ok_and(|store| !store.items().unwrap_or_default().is_empty())
        {
            break;
        }
    }
    run.kill().unwrap();
    run.wait().unwrap();
    assert_eq!(place.items(), [in_hand()]);
    assert!(place.run(CONNECT).status.success(), "the next run takes it over");
    assert_eq!(place.items().len(), 1);
}

#[test]
fn file_of_another_kind_is_refused_before_the_run() {
    let place = Place::new();
    fs::write(place.file("items.db"), "these are holiday pictures under a wrong name").unwrap();
    let output = place.run(CONNECT);
    assert_eq!(output.status.code(), Some(2));
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(error.contains("the Data System cannot keep its items") && error.contains("items.db"), "{error}");
}

/// In an earlier version the second run closed the session of the first, whose job failed.
#[test]
fn second_run_with_the_same_file_is_refused() {
    let place = Place::new();
    let first = place
        .command(&format!("{CONNECT}{FETCH}"), &["--clock", "5x", "--operator", "none"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    for _ in 0..600 {
        thread::sleep(Duration::from_millis(100));
        if place.file("items.db.lock").exists() {
            break;
        }
    }
    let second = place.run(CONNECT);
    let said = String::from_utf8_lossy(&second.stderr).into_owned();
    assert_eq!(second.status.code(), Some(2), "{said}");
    assert!(said.contains("items.db: another run or Data System uses this database"), "{said}");
    let first = first.wait_with_output().unwrap();
    assert!(first.status.success(), "{}", String::from_utf8_lossy(&first.stderr));
    assert_eq!(place.items(), [in_hand()]);
}
