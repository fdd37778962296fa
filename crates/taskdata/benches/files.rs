//! 100,000 records of task data in each file: how long a load takes, and how long a look-up (DESIGN 14).
//!
//! The look-ups go through all records in an order that no cache can guess. They allocate nothing: that part of the crate is
//! built without `alloc`.

#![expect(missing_docs, reason = "criterion_group! makes a public function without a doc comment")]

use std::{fmt::Write, hint::black_box};

use criterion::{Criterion, criterion_group, criterion_main};
use rcs_core::name::Name16;
use taskdata::{
    files::Place,
    load::{Source, Store},
};

/// Records in each of the files that grow with the number of parts.
const RECORDS: u32 = 100_000;
/// Lines that a block has, and blocks that an offset has.
const LINES: usize = 16;
const BLOCKS: usize = 1000;

/// Blocks with the given lines in them, from an offset on.
fn blocks(offset: usize, lines: impl Iterator<Item = String>) -> Source {
    let mut text = String::new();
    for (i, line) in lines.enumerate() {
        if i % LINES == 0 {
            let block = i / LINES;
            let area = offset + block / BLOCKS * 1000;
            writeln!(text, "BLOCK# {} OFFSET {area}", block % BLOCKS).expect("text has no end");
        }
        writeln!(text, "{line}").expect("text has no end");
    }
    Source { name: format!("{offset}.blk"), text: text.into() }
}

/// Parts with two grips each, one at the fixture and one anywhere; a movetable and a location point for each part.
fn sources() -> Vec<Source> {
    let place = "3800 -4400 -400 6800 -4400 -400 6800 -1400 -400 -pose- ... P
-pt- F P ...
-own- BOTH -m- lpt F -m- lpt G
-pt- G P ...
-traj F-G lpt F own BOTH
";
    let all = || 0..RECORDS;
    vec![
        Source { name: "place.blk".to_owned(), text: format!("BLOCK# 1 OFFSET 22000\n{place}").into() },
        blocks(30_000, all().map(|i| format!("1 t {} 0 0 -mtb- M{i}", i % 100))),
        blocks(40_000, all().map(|i| format!("-obj- PART{i} 2 300 60 30 350"))),
        blocks(
            50_000,
            all().map(|i| {
                if i % 2 == 0 {
                    format!("-grip- PART{i} 2 lpt F M{i}")
                } else {
                    format!("-grip- PART{i} 2 $$$ M{i} -o-loc- PART{i} lpt F")
                }
            }),
        ),
        blocks(60_000, all().skip(2).map(|i| format!("-pt- L{i} P M{i}"))),
        blocks(70_000, all().map(|i| format!("-appr obj PART{i} 2 lpt F -ppt 4 5 40 0 stop"))),
    ]
}

fn load(c: &mut Criterion, sources: &[Source]) {
    let mut load = c.benchmark_group("load");
    load.sample_size(10);
    load.bench_function("100,000 records a file, read and linked", |b| {
        b.iter(|| {
            Store::default()
                .with_blocks_untried(black_box(sources.to_vec()))
                .map(|(store, _)| store)
                .expect("the data are sound")
        });
    });
    load.bench_function("100,000 records a file, all targets tried", |b| {
        b.iter(|| {
            Store::from_sources(black_box(sources.to_vec()))
                .map(|(store, _)| store)
                .expect("the data are sound")
        });
    });
    load.finish();
}

fn bench(c: &mut Criterion) {
    let sources = sources();
    load(c, &sources);
    let (store, _) = Store::from_sources(sources).expect("the data are sound");
    let data = store.view();
    // 7919 and 100,000 have no common divisor: every name comes up, each far from the one before.
    let shuffled = |stem: &str, parity: u32| -> Vec<Name16> {
        let numbers = (0..RECORDS).map(|i| i * 7919 % RECORDS).filter(|i| i % 2 == parity);
        numbers.map(|i| Name16::clipped(&format!("{stem}{i}"))).collect()
    };
    let (even, odd) = (shuffled("PART", 0), shuffled("PART", 1));
    let place =
        |name| -> Place { data.place_of(data.locpt_named(&Name16::clipped(name)).expect("it is there")) };
    let (f, g) = (place("F"), place("G"));
    let mut even = even.iter().cycle();
    let mut odd = odd.iter().cycle();
    let mut named = || even.next().expect("a cycle has no end");
    c.bench_function("object by name", |b| b.iter(|| black_box(data.object_named(named()))));
    c.bench_function("grip by object name, grip and place", |b| {
        b.iter(|| black_box(data.grip_movetable(named(), 2, &f)));
    });
    c.bench_function("grip by the wild card, after all others in vain", |b| {
        b.iter(|| black_box(data.grip_movetable(odd.next().expect("a cycle has no end"), 2, &g)));
    });
    c.bench_function("grasp parameters by object name and grip", |b| {
        b.iter(|| black_box(data.object(named(), 2)));
    });
    c.bench_function("approach by object name, grip and place", |b| {
        b.iter(|| black_box(data.approach(named(), 2, &f)));
    });
    c.bench_function("trajectory through an owner", |b| b.iter(|| black_box(data.trajectory(&f, &g))));
}

criterion_group!(benches, bench);
criterion_main!(benches);
