//! Runs and times a hundred ticks of the control processes: `cargo run --release -p executive --example runner`.

#![expect(clippy::print_stdout, reason = "an example prints what it does")]

use executive::{alloc::Counting, runner::Runner};
use interfaces::ExternalInputs;
use levels::ladder::Ladder;
use taskdata::files::TaskData;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn main() {
    let mut runner = Runner::new(Ladder::default(), None);
    for _ in 0..100 {
        let Ok(_) = runner.step(&ExternalInputs::default(), &TaskData::default(), 0);
    }
    let times = runner.times().summary();
    println!("tick {}, {:.1} us in the middle, {:.1} us at most", runner.tick(), times.p50, times.max);
    println!("digest {}, heap allocations {:?}", runner.digest(), runner.allocations());
}
