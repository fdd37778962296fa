//! The log of any run replays: jobs with random seeds and faults on the line, cut off after random ticks.
//! `RCS_REPLAYS=30` sets the number, `RCS_REPLAYS_FROM=N` the first seed. A failure names its seed.

use std::{
    env,
    fmt::Write as _,
    fs,
    sync::atomic::{AtomicU64, Ordering},
    thread,
};

use record::{Log, golden, replay};
use whole_system_tests::{Outcome, run_with};

const FEW: u64 = 4;
const JOBS: [&str; 4] = ["linkbar", "clevis", "turned-part", "tool-change"]; // in turn
const FAULTS: [(&str, f64); 7] = [
    ("flip", 2e-4),
    ("drop", 1e-4),
    ("duplicate", 1e-4),
    ("delay", 2e-4),
    ("insert", 5e-4),
    ("truncate", 5e-4),
    ("stall", 5e-4),
];

struct Numbers(u64);

impl Numbers {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }
}

fn number(name: &str) -> Option<u64> {
    env::var(name)
        .ok()
        .map(|text| text.parse().unwrap_or_else(|_| panic!("{name} is a number, found {text:?}")))
}

/// Up to three faults; none in a third of the cases.
fn plan(numbers: &mut Numbers, seed: u64) -> Option<String> {
    let count = numbers.below(3) + numbers.below(2);
    let mut text = format!("seed = {seed}\n");
    for _ in 0..count {
        let (kind, rate) = FAULTS[numbers.below(FAULTS.len() as u64) as usize];
        let (from, length) = (numbers.below(1500), 50 + numbers.below(1500));
        let _ = writeln!(
            text,
            "[[fault]]\nkind = \"{kind}\"\nrate = {rate}\nfrom = {from}\nuntil = {}",
            from + length
        );
    }
    (count > 0).then_some(text)
}

fn outcome_of(seed: u64) -> Outcome {
    let mut numbers = Numbers(seed);
    let job = JOBS[numbers.below(JOBS.len() as u64) as usize];
    let ticks = (500 + numbers.below(2000)).to_string();
    let plan = plan(&mut numbers, seed);
    run_with(job, seed, &format!("replays-{seed}"), &["--ticks", &ticks], |scratch| {
        if let Some(plan) = &plan {
            fs::write(scratch.file("faults.toml"), plan).expect("the plan can be written");
        }
    })
}

/// Replays the log and a golden of it, and compares.
fn check(seed: u64) {
    let outcome = outcome_of(seed);
    let report = replay(&outcome.log).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
    if let Some(difference) = &report.first_difference {
        panic!("seed {seed}: {difference}");
    }
    assert!(report.is_same() && report.complete && report.skipped == 0, "seed {seed}");
    assert_eq!(report.digest.to_string(), outcome.digest(), "seed {seed}");
    let log = Log::open(&outcome.log).expect("it was replayed");
    let golden = golden::from_log(&log).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
    let played = golden::replay(&golden).unwrap_or_else(|error| panic!("seed {seed}: {error}"));
    assert_eq!((played.difference, played.ticks), (None, report.ticks), "seed {seed}");
}

#[test]
fn runs_with_random_seeds_and_faults_replay() {
    let next = AtomicU64::new(number("RCS_REPLAYS_FROM").unwrap_or(1));
    let end = next.load(Ordering::Relaxed) + number("RCS_REPLAYS").unwrap_or(FEW);
    let check_in_turn = || {
        loop {
            match next.fetch_add(1, Ordering::Relaxed) {
                seed if seed < end => check(seed),
                _ => return,
            }
        }
    };
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(check_in_turn);
        }
    });
}
