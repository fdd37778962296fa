//! Readers that are killed or stopped do not affect the run.

use std::{path::Path, process::Child, thread, time::Duration};

use rustix::process::{Pid, Signal, kill_process};
use whole_system_tests::{Scratch, bench::Ended};

use crate::{
    processes::Process,
    runs::{BOARDS, assert_no_harm, end, judge, start},
    table::{Chance, Extent, Outcome, Row},
};

const TICKS: &str = "100"; // per run
const READERS: u64 = 6; // killed per run

fn kill(mut reader: Child) {
    reader.kill().expect("it can be killed");
    reader.wait().expect("it is dead");
}

/// One reader after the other is killed; one is stopped until the end.
fn die_and_hang(directory: &Path, boards: &str, expected: &str, chance: &mut Chance) -> Outcome {
    let mut run = start(directory, boards, TICKS, "none");
    drop(run.attach());
    let name = run.name.clone();
    let hangs = Process::Reader.start(&name).expect("the run has just begun");
    kill_process(Pid::from_child(&hangs), Signal::STOP).expect("it can be stopped");
    for _ in 0..READERS {
        let Some(reader) = Process::Reader.start(&name) else {
            // On a busy machine the readers may take longer than the run.
            assert!(run.child.try_wait().expect("a child").is_some(), "a reader could not begin");
            break;
        };
        thread::sleep(Duration::from_millis(chance.below(60)));
        kill(reader);
    }
    let ended = end(run);
    kill(hangs);
    assert_eq!(ended.status, Some(0), "{}", ended.said);
    assert_eq!(ended.number("allocations_after_start"), 0);
    assert_eq!(ended.result["digest_before_ramp"], expected);
    assert_no_harm(directory, &name);
    judge(&ended)
}

pub fn rows(extent: Extent) -> Vec<Row> {
    let scratch = Scratch::new("readers");
    let place = scratch.file("");
    let alone = ["--ticks", TICKS, "--log", "none", "--shared-memory", "off"];
    let expected = Ended::run(&place, "linkbar", &alone).digest().to_owned();
    let attack = format!("{READERS} readers killed, one stopped");
    let row = |(boards, on)| {
        Row::of(extent, &attack, on, 0..extent.of(10, 1), |_, chance| {
            die_and_hang(&place, boards, &expected, chance)
        })
    };
    BOARDS.into_iter().map(row).collect()
}
