//! Times of a load and of look-ups with 100,000 records in one file, and in all files at once. A load ends when the
//! data are ready. Look-ups are timed warm (a few records repeatedly), cold (all records, shuffled; several times the
//! caches of a core), and with the caches emptied.

use std::{fmt::Write, hint::black_box, time::Duration};

use criterion::{Criterion, criterion_group, criterion_main};
use rcs_core::name::Name16;
use rustix::time::{ClockId, clock_gettime};
use taskdata::{
    files::Place,
    load::{Source, Store},
};

const RECORDS: u32 = 100_000; // in each file that grows with the number of parts
const DIRT: usize = 64 << 20; // bytes written to empty the caches
const AT_A_TIME: usize = 250;
const LINES: usize = 16; // in a block, and blocks at an offset
const BLOCKS: usize = 1000;

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

/// Parts with two grips, one at the fixture and one anywhere; each has a movetable and a location point.
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

/// Texts that give one file 100,000 records, and the other files only the necessary ones.
fn one_file_each() -> Vec<(&'static str, Vec<Source>)> {
    let pose = |name: &str| format!("3800 -4400 0 6800 -4400 0 6800 -1400 0 -pose- ... {name}");
    let all = || 0..RECORDS;
    // Pairs of numbers, the first below `first`.
    let pairs = |first: u32| all().map(move |i| (i % first, i / first));
    let part = |i: u32| format!("-obj- PART{i} 2 300 60 30 350");
    let point = |i: u32| format!("-pt- L{i} P ...");
    let place = || {
        vec![Source {
            name: "place.blk".to_owned(),
            text: format!("BLOCK# 1 OFFSET 22000\n{}\n", pose("P")).into(),
        }]
    };
    let with = |lists: Vec<Source>| place().into_iter().chain(lists).collect::<Vec<_>>();
    let parts_and_points = || {
        vec![
            blocks(30_000, (0..400).map(part)),
            blocks(40_000, (0..320).map(point)),
            blocks(50_000, ["1 t 10 0 0 -mtb- M".to_owned()].into_iter()),
        ]
    };
    let also = |offset, lines: Vec<String>| {
        with(parts_and_points().into_iter().chain([blocks(offset, lines.into_iter())]).collect())
    };
    vec![
        ("POSE", with(vec![blocks(60_000, all().skip(1).map(|i| pose(&format!("P{i}"))))])),
        ("MOVTAB", with(vec![blocks(60_000, all().map(|i| format!("1 t {} 0 0 -mtb- M{i}", i % 100)))])),
        ("LOCPT", with(vec![blocks(60_000, all().map(point))])),
        (
            "TRAJ",
            also(60_000, pairs(319).map(|(i, j)| format!("-traj T{i}-{j} lpt L{i} lpt L{j}")).collect()),
        ),
        ("OBJ-ASCII-NAMES", with(vec![blocks(60_000, all().map(part))])),
        ("GRIP-LOC", also(60_000, pairs(400).map(|(i, j)| format!("-grip- PART{i} 2 lpt L{j} M")).collect())),
        (
            "APPR-DEPT",
            also(
                60_000,
                pairs(400).map(|(i, j)| format!("-appr obj PART{i} 2 lpt L{j} -ppt 4 5 40 0 stop")).collect(),
            ),
        ),
    ]
}

fn load(c: &mut Criterion, sources: &[Source]) {
    let mut load = c.benchmark_group("load");
    load.sample_size(10);
    let tried = |sources: &[Source]| {
        Store::from_sources(black_box(sources.to_vec()))
            .map(|(store, _)| store)
            .unwrap_or_else(|report| panic!("the data are sound: {report}"))
    };
    for (file, sources) in one_file_each() {
        load.bench_function(format!("100,000 records in {file}, all targets tried"), |b| {
            b.iter_with_large_drop(|| tried(&sources));
        });
    }
    load.bench_function("100,000 records in each file, read and linked", |b| {
        b.iter_with_large_drop(|| {
            Store::default()
                .with_blocks_untried(black_box(sources.to_vec()))
                .map(|(store, _)| store)
                .expect("the data are sound")
        });
    });
    load.bench_function("100,000 records in each file, all targets tried", |b| {
        b.iter_with_large_drop(|| tried(sources));
    });
    load.finish();
}

/// Names of all even or odd parts, each far from the previous one.
fn shuffled(parity: u32) -> Vec<Name16> {
    // 7919 and 100,000 have no common divisor, so every name occurs.
    let numbers = (0..RECORDS).map(|i| i * 7919 % RECORDS).filter(|i| i % 2 == parity);
    numbers.map(|i| Name16::clipped(&format!("PART{i}"))).collect()
}

fn processor_time() -> Duration {
    clock_gettime(ClockId::ThreadCPUTime).try_into().expect("it counts up from zero")
}

fn look_up(c: &mut Criterion, what: &str, names: &[Name16], find: impl Fn(&Name16) -> u32) {
    let nothing = black_box(0); // each look-up depends on the previous one, or the processor would overlap them
    let chain = |names: &[Name16], times: u64| {
        let mut position = 0;
        for _ in 0..times {
            let found = find(&names[position]) & nothing;
            position = (position + 1 + usize::try_from(found).expect("it is zero")) % names.len();
        }
        black_box(position);
    };
    let mut group = c.benchmark_group(what);
    let timed = |names: &[Name16], times| {
        let begin = processor_time();
        chain(names, times);
        processor_time() - begin
    };
    group.bench_function("warm: the same 16 parts", |b| b.iter_custom(|times| timed(&names[..16], times)));
    group.bench_function("cold: all parts in no order", |b| b.iter_custom(|times| timed(names, times)));
    let mut dirt = vec![1_u8; DIRT];
    let mut next = names.chunks_exact(AT_A_TIME).cycle();
    group.bench_function("caches emptied before", |b| {
        b.iter_custom(|times| {
            let batches = times.div_ceil(AT_A_TIME as u64);
            let mut sum = Duration::ZERO;
            for _ in 0..batches {
                dirt.iter_mut().step_by(64).for_each(|byte| *byte = byte.wrapping_add(1));
                let names = black_box(next.next().expect("a cycle has no end").to_vec());
                sum += timed(&names, AT_A_TIME as u64);
            }
            sum.mul_f64(times as f64 / (batches * AT_A_TIME as u64) as f64)
        });
    });
    group.finish();
}

fn bench(c: &mut Criterion) {
    let sources = sources();
    load(c, &sources);
    let (store, _) = Store::from_sources(sources).expect("the data are sound");
    let data = store.view();
    let (even, odd) = (shuffled(0), shuffled(1));
    let place =
        |name| -> Place { Place::point(data.locpt_named(&Name16::clipped(name)).expect("it is there")) };
    let (f, g) = (place("F"), place("G"));
    look_up(c, "object by name", &even, |name| data.object_named(name).expect("it is there").number());
    look_up(c, "grip by object name, grip and place", &even, |name| {
        data.grip_movetable(name, 2, &f).expect("it is there").number()
    });
    look_up(c, "grip by the wild card, after all others without a match", &odd, |name| {
        data.grip_movetable(name, 2, &g).expect("it is there").number()
    });
    look_up(c, "grasp parameters by object name and grip", &even, |name| {
        data.object(name, 2).expect("it is there").1.grasp_size.cast_unsigned()
    });
    look_up(c, "approach by object name, grip and place", &even, |name| {
        data.approach(name, 2, &f).expect("it is there").number()
    });
    c.bench_function("trajectory through an owner", |b| b.iter(|| black_box(data.trajectory(&f, &g))));
}

criterion_group!(benches, bench);
criterion_main!(benches);
