//! Cost of a tick of the simulated cell (at rest, with a part in the fingers, while the vise closes on it), of its
//! digest, of saving and restoring. Each sample starts from the same saved cell: `cargo bench -p plant --bench cell`.

#[path = "../tests/rig/mod.rs"]
mod rig;

use std::{hint::black_box, time::Duration};

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use plant::Cell;
use rig::{
    Rig, description, scenes,
    tape::{Beat, Tape},
};

const TICKS: usize = 25;

struct BenchCase {
    cell: Vec<u8>,
    beats: Vec<Beat>,
}

/// The `TICKS` ticks from the first one for which `begins` returns true.
fn stretch(tape: &Tape, seed: u64, begins: impl Fn(&Cell) -> bool) -> BenchCase {
    let mut cell = Cell::new(&description(), seed).expect("the cell of the project");
    let at = tape.beats.iter().position(|beat| {
        beat.play(&mut cell);
        begins(&cell)
    });
    let from = at.expect("the scene has such a moment") + 1;
    let beats = tape.beats[from..from + TICKS].to_vec();
    BenchCase { cell: cell.save().expect("the cell can be saved"), beats }
}

fn ticks(criterion: &mut Criterion, name: &str, stretch: &BenchCase) {
    let description = description();
    criterion.benchmark_group("25 ticks").bench_function(name, |bencher| {
        bencher.iter_batched_ref(
            || Cell::restore(&description, &stretch.cell).expect("it was saved"),
            |cell| stretch.beats.iter().for_each(|beat| beat.play(cell)),
            BatchSize::SmallInput,
        );
    });
}

fn cell(criterion: &mut Criterion) {
    let mut idle = Rig::new(&description(), 1);
    for sector in 1..=4 {
        idle.place("LINKBAR1_BH", sector, 0.0, 0.0, 20.0);
    }
    idle.ticks(100);
    let bytes = idle.cell.save().expect("the cell can be saved");
    let still = BenchCase { cell: bytes.clone(), beats: vec![Beat::default(); TICKS] };
    ticks(criterion, "arm and four parts at rest", &still);

    let tape = scenes::clamping(1).tape.expect("it is on tape");
    let held = |cell: &Cell| cell.parts().iter().any(|part| part.held);
    ticks(criterion, "part lifted out of the tray", &stretch(&tape, 1, held));
    let between = |cell: &Cell| held(cell) && cell.workstation_busy();
    ticks(criterion, "vise closing on a held part", &stretch(&tape, 1, between));
    let dropped = |cell: &Cell| {
        let mut parts = cell.parts().into_iter();
        parts.any(|part| {
            part.name == "LINKBAR1_BH" && part.location == "PFIXTURE" && !part.held && !part.clamped
        })
    };
    ticks(criterion, "part on the ledge", &stretch(&tape, 1, dropped));

    criterion.bench_function("digest", |bencher| bencher.iter(|| black_box(&idle.cell).digest()));
    criterion.bench_function("save", |bencher| bencher.iter(|| black_box(&idle.cell).save()));
    let description = description();
    criterion.bench_function("restore", |bencher| {
        bencher.iter(|| Cell::restore(&description, black_box(&bytes)));
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(Duration::from_secs(4));
    targets = cell
}
criterion_main!(benches);
