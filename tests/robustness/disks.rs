//! Disks and shared memory that fill, and limits of files.

use whole_system_tests::{Scratch, bench::apart};

use crate::{
    runs::{BOARDS, judge},
    table::{Extent, Outcome, Row},
};

const TICKS: u64 = 400;

/// Name, shell commands that set the limit of `SIZE` kilobytes before the run, and largest size to try.
const LIMITS: [(&str, &str, u64); 3] = [
    ("a limit of N KB on files", "ulimit -f $((2 * SIZE))", 2_000), // the shell uses blocks of 512 bytes
    ("a disk of N KB for the log", "mkdir disk && mount -t tmpfs -o size=SIZEk tmpfs disk", 600),
    ("N KB of shared memory", "mkdir disk && mount -t tmpfs -o size=SIZEk tmpfs /dev/shm", 3_000),
];

fn attempt(commands: &str, size: u64, boards: &str) -> Outcome {
    let scratch = Scratch::new("disks");
    let ticks = TICKS.to_string();
    let more = ["--boards", boards, "--ticks", &ticks, "--log", "disk/run.mcap"];
    let shell = commands.replace("SIZE", &size.to_string());
    let ended = apart(&scratch.file(""), &shell, &more).expect("this program could mount before");
    let outcome = judge(&ended);
    match outcome {
        Outcome::WentOn => assert_eq!(ended.number("ticks"), TICKS, "{size} KB: {}", ended.said),
        Outcome::InWords => {}
        Outcome::InOrder | Outcome::BySignal => panic!("{size} KB: {:?}: {}", ended.signal, ended.said),
    }
    outcome
}

pub fn rows(extent: Extent) -> Vec<Row> {
    let mut rows = Vec::new();
    for (attack, commands, most) in LIMITS {
        for (boards, on) in BOARDS {
            rows.push(Row::of(extent, attack, on, 0..extent.of(20, 2), |_, chance| {
                attempt(commands, 16 + chance.below(most), boards)
            }));
        }
    }
    rows
}
