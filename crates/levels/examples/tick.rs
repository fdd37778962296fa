//! Two ticks of all control processes without a cell: `cargo run --release -p levels --example tick`.

#![expect(clippy::print_stdout, reason = "an example prints what it does")]

use interfaces::{CommonMemory, ExternalInputs, HwsCommand};
use levels::ladder::Ladder;
use rcs_core::{name::Name16, tick::Tick};
use taskdata::files::TaskData;

fn main() {
    let mut ladder = Ladder::default();
    let pause = HwsCommand { number: 1, command: Name16::clipped("PAUSE"), ..HwsCommand::default() };
    let external = ExternalInputs { hws: pause, ..ExternalInputs::default() };
    let mut before = CommonMemory::default();
    for tick in (1..=2).map(Tick) {
        // Each process reads the buffers of the tick before, and writes its own.
        let mut after = before;
        ladder.step(tick, &before, &external, &TaskData::default(), &mut after);
        let task = &after.task.status;
        println!("tick {tick}: Task has echoed command {} and reports {}", task.echo, task.report);
        before = after;
    }
}
