//! The shipped jobs finish for any sensor noise and places of random parts; linkbar and clevis from every suitable
//! sector of data/README.md.
//!
//! ```text
//! RCS_SEEDS=20 cargo test --release -p whole-system-tests --test runs seeds -- --nocapture
//! ```
//!
//! runs each with the seeds 1 to 20 and prints a table (docs/evidence.md); without the variable, three run with seed
//! 1.

use std::{
    env, fs, iter,
    sync::atomic::{AtomicUsize, Ordering},
    thread,
};

use whole_system_tests::{Scratch, root, run};

const JOBS: [&str; 7] =
    ["linkbar", "clevis", "turned-part", "tool-change", "shift", "vise-and-back", "brush"];
/// Job, its sector, and the other suitable sectors (data/README.md).
const RANDOM: [(&str, &str, &[&str]); 2] = [
    ("linkbar", "UNIT_1 4", &["UNIT_1 1", "UNIT_1 2", "UNIT_1 3", "UNIT_2 1", "UNIT_2 2"]),
    ("clevis", "UNIT_1 3", &["UNIT_1 1", "UNIT_1 2", "UNIT_1 4"]),
];

#[derive(Clone, Copy)]
struct Kind {
    job: &'static str,
    sector: Option<[&'static str; 2]>,
}

impl Kind {
    fn in_words(&self) -> String {
        self.sector.map_or_else(|| self.job.to_owned(), |[_, to]| format!("{} from {to}", self.job))
    }

    fn fails(&self, seed: u64) -> Option<String> {
        let outcome = match self.sector {
            None => run(self.job, seed, "seeds", |_| {}),
            Some([from, to]) => {
                let file = format!("{}.job", self.job);
                run(&file, seed, "seeds", |scratch: &Scratch| {
                    let text = fs::read_to_string(root().join("data/jobs").join(&file));
                    let text = text.expect("the job is there").replace(from, to);
                    fs::write(scratch.file(&file), text).expect("the job can be written");
                })
            }
        };
        (outcome.status != Some(0)).then_some(outcome.last_words)
    }
}

fn kinds() -> Vec<Kind> {
    let shipped = JOBS.map(|job| Kind { job, sector: None });
    let sectors = RANDOM
        .iter()
        .flat_map(|(job, from, others)| others.iter().map(|to| Kind { job, sector: Some([*from, *to]) }));
    shipped.into_iter().chain(sectors).collect()
}

/// Runs seeds on two threads. Returns the kinds that have not finished, with the reason.
fn failed(kinds: &[Kind], seeds: usize) -> Vec<(usize, String)> {
    let next = AtomicUsize::new(0);
    let work = || {
        let numbers = iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed));
        let taken = numbers
            .map_while(|number| Some((number / seeds, number % seeds + 1, kinds.get(number / seeds)?)));
        let failed = taken.filter_map(|(kind, seed, one)| {
            Some((kind, format!("seed {seed}: {}", one.fails(u64::try_from(seed).expect("small"))?)))
        });
        failed.collect::<Vec<_>>()
    };
    thread::scope(|scope| {
        let threads = [scope.spawn(work), scope.spawn(work)];
        threads.map(|thread| thread.join().expect("no run panics")).concat()
    })
}

#[test]
fn shipped_jobs_and_fit_sectors_finish_with_every_seed() {
    let all = env::var("RCS_SEEDS").ok().map(|text| text.parse().expect("RCS_SEEDS is a number"));
    let mut kinds = kinds();
    if all.is_none() {
        kinds.retain(|kind| kind.sector.is_some_and(|[_, to]| to.ends_with(" 2")));
    }
    let seeds: usize = all.unwrap_or(1);
    let failed = failed(&kinds, seeds);
    if all.is_some() {
        println!("| job | seeds | finished |\n|---|---:|---:|");
        for (number, kind) in kinds.iter().enumerate() {
            let finished = seeds - failed.iter().filter(|(other, _)| *other == number).count();
            println!("| {} | {seeds} | {finished} |", kind.in_words());
        }
    }
    let words: Vec<String> =
        failed.iter().map(|(kind, why)| format!("{}, {why}", kinds[*kind].in_words())).collect();
    assert!(words.is_empty(), "{}", words.join("\n"));
}
