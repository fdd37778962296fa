//! Killed runs: the log replays to the last second, the next run works at once, and no files remain.

use std::fs;

use executive::memory::ReadError;
use record::replay;
use rustix::process::Signal;
use whole_system_tests::{
    Scratch,
    bench::{Ended, Running, assert_cleaned, rcs, traces, wait_for},
};

const JOBS: [(&str, u64); 4] = // lengths in ticks
    [("linkbar", 5_900), ("clevis", 11_000), ("turned-part", 6_000), ("tool-change", 7_000)];
/// In fast clock the log may lack its ring (1,024 ticks) and one write (25).
const BEHIND_FAST: u64 = 1024 + 25 + 25;
const BEHIND_REAL: u64 = 2 * 25; // in real clock it writes once per second; one more for a delayed log thread
const ATTEMPTS: u32 = 5; // other load may delay the log thread for longer in one attempt

fn kills() -> u64 {
    std::env::var("RCS_KILLS").map_or(4, |text| text.parse().expect("RCS_KILLS is a number"))
}

/// Number of ticks in the log of a killed run, which replays.
fn ticks_in(log: &std::path::Path) -> u64 {
    let report = replay(log).expect("the log of a killed run can be read");
    if let Some(difference) = &report.first_difference {
        panic!("{difference}");
    }
    assert!(!report.complete);
    report.ticks
}

#[test]
fn a_run_may_be_killed_in_any_phase_of_a_job() {
    let scratch = Scratch::new("kills");
    for kill in 0..kills() {
        // The steps follow the golden ratio, so that all phases occur, in a different order in every job.
        let (job, length) = JOBS[usize::try_from(kill % 4).expect("small")];
        let phase = (kill as f64 * 0.618_033_988_75).fract();
        let target = BEHIND_FAST + 25 + (phase * (length - 1_500) as f64) as u64;
        let log = scratch.file("killed.mcap");
        let mut run = Running::start(&scratch.file(""), job, &["--log", "killed.mcap"]);
        let reader = run.attach();
        let tick = run.reach(&reader, target);
        // Half of the runs leave a reader, which can still read the buffers.
        let reader = (kill % 2 == 0).then_some(reader);
        run.kill();
        let logged = ticks_in(&log);
        assert!(logged + BEHIND_FAST >= tick, "{logged} ticks in the log, killed after {tick}");
        if let Some(reader) = reader {
            // A killed writer can leave half a tick, which readers detect.
            match reader.memory() {
                Ok(memory) => assert!(memory.task.header.stamp.0 >= tick),
                Err(error) => assert_eq!(error, ReadError::Busy),
            }
        }
        let next = Ended::run(&scratch.file(""), job, &["--ticks", "30", "--log", "none"]);
        next.assert_shared();
        assert_eq!(next.number("ticks"), 30);
        assert_cleaned(&scratch.file(""), &run.name);
    }
}

#[test]
fn in_real_time_a_kill_costs_a_second_of_the_log() {
    let scratch = Scratch::new("real-kill");
    let more = ["--clock", "real", "--log", "killed.mcap"];
    let killed = |_| {
        let mut run = Running::start(&scratch.file(""), "linkbar", &more);
        let reader = run.attach();
        let tick = run.reach(&reader, 110);
        drop(reader);
        run.kill();
        assert!(!traces(&run.name).is_empty(), "a killed run leaves something");
        let lost = tick.saturating_sub(ticks_in(&scratch.file("killed.mcap")));
        assert_cleaned(&scratch.file(""), &run.name);
        lost
    };
    let kept = (0..ATTEMPTS).map(killed).find(|lost| *lost <= BEHIND_REAL);
    assert!(kept.is_some(), "more than {BEHIND_REAL} ticks were lost in each of {ATTEMPTS} attempts");
}

#[test]
fn a_killed_run_is_resumed_from_its_journal() {
    let scratch = Scratch::new("resume");
    let directory = scratch.file("");
    for kill in 0..kills() {
        // Before, the gripper is not calibrated: then a person must say what it holds.
        let target = 150.0 + (kill as f64 * 0.618_033_988_75).fract() * 5_400.0;
        let more = ["--clock", "20x", "--log", "none"];
        let journal = [&more[..], &["--journal", "run.journal"]].concat();
        let mut run = Running::start(&directory, "linkbar", &journal);
        let reader = run.attach();
        let tick = run.reach(&reader, target as u64);
        drop(reader);
        run.kill();
        let resume = [&more[..], &["--resume", "run.journal"]].concat();
        let mut run = Running::start(&directory, "linkbar", &resume);
        drop(run.attach());
        let go = ["send", "--run", run.name.as_str(), "resume", "job go"];
        wait_for("the job continues", || {
            rcs(&directory, &go).output().is_ok_and(|sent| sent.status.success())
        });
        let ended = run.end();
        assert_eq!(ended.status, Some(0), "killed after {tick}: {}", ended.last_words());
    }
}

#[test]
fn journal_that_is_not_written_shows_in_status_and_result() {
    let scratch = Scratch::new("no-journal");
    let directory = scratch.file("");
    let more = ["--clock", "20x", "--log", "none", "--journal", "run.journal"];
    let mut run = Running::start(&directory, "linkbar", &more);
    let reader = run.attach();
    run.reach(&reader, 60);
    drop(reader);
    fs::remove_file(scratch.file("run.journal")).expect("the run has a journal");
    wait_for("the status reports the journal", || {
        let status =
            rcs(&directory, &["status", run.name.as_str()]).output().expect("rcs-run can be started");
        String::from_utf8_lossy(&status.stdout).contains("runs; its journal is not written: ")
    });
    run.signal(Signal::INT);
    let ended = run.end();
    let trouble = ended.result["journal_trouble"].as_str().unwrap_or_default();
    assert!(trouble.contains("was removed during the run"), "{}", ended.result);
}
