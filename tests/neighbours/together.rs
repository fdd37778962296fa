//! Every neighbour in its own process for a whole shift: the same bits, and the Data System has all items.

use std::{
    path::Path,
    process::{Child, Command, Stdio},
};

use neighbours::data_system::{Item, Records as _};
use sessions::data_system::Store;
use whole_system_tests::{Scratch, rcs_neighbour, root};

use super::bench::{Controller, computed, computed_alone};

fn items(file: &Path) -> Vec<Item> {
    Store::open(file).expect("a database").items().expect("items")
}

/// [`computed`] of a shift with all neighbours in the controller's process, and its items.
fn shift_alone() -> (u64, Vec<Item>) {
    let scratch = Scratch::new("inside");
    let file = scratch.file("items.db");
    let bits = computed_alone("shift", &["--database", &file.display().to_string()]);
    (bits, items(&file))
}

fn start(program: &Path, address: &str, words: &[&str]) -> Child {
    Command::new(program)
        .args(words)
        .args(["--wait", "1", "--network", address])
        .current_dir(root())
        .stdout(Stdio::null())
        .spawn()
        .expect("rcs-neighbour can be started")
}

#[test]
fn shift_with_external_neighbours_has_the_same_bits_and_items() {
    let ((bits, known), program) = (shift_alone(), rcs_neighbour());
    assert!(!known.is_empty(), "a shift has items");
    let scratch = Scratch::new("everybody");
    let (outbox, file) = (scratch.file("outbox").display().to_string(), scratch.file("items.db"));
    let everybody = "workstation,data-system,pedestal,vision";
    let logs = Scratch::new("everybody-log");
    let log = logs.file("run.mcap");
    let more = ["--json", "--outbox", &outbox, "--log", log.to_str().expect("a path")];
    let controller = Controller::start_at(scratch, None, everybody, &more);
    let (address, data_base) = (controller.address.to_string(), file.display().to_string());
    let servants = [&["data-system", &data_base][..], &["pedestal"], &["vision"]];
    let mut servants = servants.map(|words| start(program, &address, words));
    let mut chief = start(program, &address, &["workstation", "shift"]);
    assert!(chief.wait().expect("a child").success());
    let mut told = Vec::new();
    let ended = controller.end_with(|| {
        for servant in &mut servants {
            assert!(servant.wait().expect("a child").success(), "it ends when no run comes");
        }
        told = items(&file);
    });
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert_eq!(computed(&log), bits);
    assert_eq!(ended.result["allocations_after_start"], 0);
    assert_eq!(told, known);
}
