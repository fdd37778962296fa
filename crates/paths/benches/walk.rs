//! Measures the check of `rcs-run check`: all paths of the shipped jobs, and all segments of the stored trajectories.

use std::{hint::black_box, path::Path};

use criterion::{Criterion, criterion_group, criterion_main};
use paths::{job::walk_job, known::Known, stored::walk_stored};
use plant::{CellDescription, room::Room};
use taskdata::load::{Job, Store};

const JOBS: [&str; 5] = ["linkbar", "clevis", "turned-part", "tool-change", "shift"];

fn walks(criterion: &mut Criterion) {
    let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data"));
    let (store, _) = Store::load(data).unwrap();
    let load = |name: &&str| Job::load(&data.join("jobs").join(format!("{name}.job")), &store).unwrap().0;
    let jobs: Vec<Job> = JOBS.iter().map(load).collect();
    let room = Room::new(&CellDescription::load(&data.join("cell.toml")).unwrap());
    let mut group = criterion.benchmark_group("walk");
    group.sample_size(10);
    group.bench_function("all jobs", |bencher| {
        bencher.iter(|| {
            let known = Known::default();
            jobs.iter()
                .map(|job| walk_job(black_box(job), &store, &room, &known).findings.len())
                .sum::<usize>()
        });
    });
    group.bench_function("stored segments", |bencher| {
        bencher.iter(|| walk_stored(black_box(&store), &room, &Known::default()).findings.len());
    });
    group.finish();
}

criterion_group!(benches, walks);
criterion_main!(benches);
