//! Runs and times a hundred ticks of the control processes: `cargo run --release -p executive --example runner`.

#![expect(clippy::print_stdout, reason = "an example prints what it does")]

use closed_loop::{Present, course::Course};
use executive::{alloc::Counting, runner::Runner};
use interfaces::ExternalInputs;
use taskdata::files::TaskData;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn main() {
    let (mut course, mut runner) = (Course::new(Present::default()), Runner::new(None));
    for _ in 0..100 {
        let Ok(()) = runner.step(&mut course, &ExternalInputs::default(), &TaskData::default(), 0);
    }
    let times = runner.times().summary();
    println!("tick {}, {:.1} us in the middle, {:.1} us at most", course.tick(), times.p50, times.max);
    println!("digest {}, heap allocations {:?}", course.digest(), runner.allocations());
}
