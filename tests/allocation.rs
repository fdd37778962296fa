//! No allocation after the start: whole shifts with different seeds, failing jobs, a faulty line. `RCS_TICKS` sets the
//! number of ticks (default 30,000; the promised figure is 1,000,000), `RCS_BOARDS` the distribution of the processes
//! (default `one`).

use std::{fs, process::Command};

use serde_json::Value;
use whole_system_tests::{Scratch, rcs_run, root};

const TICKS: u64 = 30_000;

/// Job, expected exit status, and whether the line has faults.
struct Kind {
    job: &'static str,
    status: i32,
    faults: bool,
}

const fn kind(job: &'static str, status: i32, faults: bool) -> Kind {
    Kind { job, status, faults }
}

const KINDS: [Kind; 4] = [
    kind("no-part.job", 1, false),
    kind("linkbar", 0, true),
    kind("held-tool.job", 1, false),
    kind("shift", 0, false),
];

#[test]
fn no_heap_is_allocated_after_the_start() {
    let wanted =
        std::env::var("RCS_TICKS").map_or(TICKS, |text| text.parse().expect("RCS_TICKS is a number"));
    let boards = std::env::var("RCS_BOARDS").unwrap_or_else(|_| "one".to_owned());
    let scratch = Scratch::new("allocation");
    // One job misses an object, the other names an unknown place.
    scratch.job_with("clevis.job", "** tray UNIT_1 3 LCLEVIS_BH", "%");
    fs::rename(scratch.file("clevis.job"), scratch.file("no-part.job")).expect("a job");
    scratch.job_with("tool-change.job", "** drum release", "%");
    fs::rename(scratch.file("tool-change.job"), scratch.file("held-tool.job")).expect("a job");
    let (mut ticks, mut seed) = (0, 0);
    while ticks < wanted {
        let kind = &KINDS[seed % KINDS.len()];
        seed += 1;
        let mut command = Command::new(rcs_run());
        command
            .args(["run", kind.job, "--json", "--log", "run.mcap", "--boards", &boards])
            .args(["--seed", &seed.to_string()])
            .args(["--ticks", &(wanted - ticks).to_string(), "--data"])
            .arg(root().join("data"))
            .current_dir(scratch.file(""));
        if kind.faults {
            command.arg("--faults").arg(root().join("data/faults/broken-frames.toml"));
        }
        let output = command.output().expect("rcs-run can be started");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let result: Value = serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{said}"));
        let run = result["ticks"].as_u64().expect("ticks");
        assert_eq!(result["allocations_after_start"], 0, "{}, seed {seed}: {said}", kind.job);
        let cut = ticks + run >= wanted;
        assert!(cut || output.status.code() == Some(kind.status), "{}, seed {seed}: {said}", kind.job);
        ticks += run;
    }
    println!("{ticks} ticks in {seed} runs, --boards {boards}: 0 allocations");
}
