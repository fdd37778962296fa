//! 100,000 records of task data: how long a load takes, and how long a look-up (DESIGN 14).

#![expect(missing_docs, reason = "criterion_group! makes a public function without a doc comment")]

use std::{fmt::Write, hint::black_box};

use criterion::{Criterion, criterion_group, criterion_main};
use rcs_core::name::Name16;
use taskdata::load::{Source, Store};

/// Records in each of the files that grow with the number of parts.
const RECORDS: u32 = 100_000;

/// Blocks of 16 lines with the given lines in them.
fn blocks(offset: u32, lines: impl Iterator<Item = String>) -> Source {
    let mut text = String::new();
    for (i, line) in lines.enumerate() {
        if i % 16 == 0 {
            writeln!(text, "BLOCK# {} OFFSET {offset}", i / 16).expect("text has no end");
        }
        writeln!(text, "{line}").expect("text has no end");
    }
    Source { name: format!("{offset}.blk"), text: text.into() }
}

/// Objects with a grip at a fixture each, and a movetable for each grip.
fn sources() -> Vec<Source> {
    let place = "3800 -4400 -400 6800 -4400 -400 6800 -1400 -400 -pose- ... P\n-pt- F P ...\n";
    vec![
        Source { name: "place.blk".to_owned(), text: format!("BLOCK# 1 OFFSET 22000\n{place}").into() },
        blocks(21_001, (0..RECORDS).map(|i| format!("1 t {} 0 0 -mtb- M{i}", i % 100))),
        blocks(21_002, (0..RECORDS).map(|i| format!("-obj- PART{i} 2 300 60 30 350"))),
        blocks(21_003, (0..RECORDS).map(|i| format!("-grip- PART{i} 2 lpt F M{i}"))),
    ]
}

fn bench(c: &mut Criterion) {
    let sources = sources();
    let mut load = c.benchmark_group("load");
    load.sample_size(10);
    load.bench_function("300,000 records", |b| {
        b.iter(|| {
            Store::from_sources(black_box(sources.clone()))
                .map(|(store, _)| store)
                .expect("the data are sound")
        });
    });
    load.finish();

    let (store, _) = Store::from_sources(sources).expect("the data are sound");
    let data = store.view();
    let names: Vec<Name16> =
        (0..1024_u32).map(|i| Name16::clipped(&format!("PART{}", i * 7919 % RECORDS))).collect();
    let fixture = data.place_of(data.locpt_named(&Name16::clipped("F")).expect("it is there"));
    let mut next = names.iter().cycle();
    c.bench_function("object by name", |b| {
        b.iter(|| black_box(data.object_named(next.next().expect("a cycle has no end"))));
    });
    c.bench_function("grip movetable by object name, grip and place", |b| {
        b.iter(|| black_box(data.grip_movetable(next.next().expect("a cycle has no end"), 2, &fixture)));
    });
    c.bench_function("grasp parameters by object name and grip", |b| {
        b.iter(|| black_box(data.object(next.next().expect("a cycle has no end"), 2)));
    });
}

criterion_group!(benches, bench);
criterion_main!(benches);
