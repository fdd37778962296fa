//! The linkbar job inside another program: `cargo run --release -p runtime --example embed`.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "an example prints what it does")]

use rcs_core::tick::TICK_S;
use runtime::{Ending, LogTarget, Observer, Run, RunConfig, StartError, TickReport};

#[derive(Default)]
struct Lines(usize);

impl Observer for Lines {
    fn message(&mut self, text: &str) {
        eprintln!("{text}");
    }

    fn tick(&mut self, report: &TickReport<'_>) {
        for step in report.steps.iter().skip(self.0) {
            println!("{:>6.1} s  {}", report.tick.0 as f64 * TICK_S, step.text);
        }
        self.0 = report.steps.len();
    }
}

fn main() -> Result<(), StartError> {
    let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data");
    let config = RunConfig { log: LogTarget::None, shared_memory: false, ..RunConfig::new(data, "linkbar") };
    let outcome = Run::new(config, Box::new(Lines::default()))?.complete();
    match &outcome.ending {
        Ending::Finished => {
            println!("finished after {} ticks, digest {}", outcome.result.ticks, outcome.result.digest)
        }
        Ending::Stopped | Ending::StoppedByUser => println!("stopped"),
        Ending::Failed(account) => println!("failed at tick {}: {account}", account.first.tick),
    }
    for part in &outcome.result.parts {
        println!("{part}");
    }
    Ok(())
}
