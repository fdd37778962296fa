//! Prints the devices and points of a mapping, or its mistakes.
//!
//! `cargo run --release -p field --example points -- data/field/station.toml`

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "an example prints")]

use std::process::ExitCode;

use diagnostics::Source;
use field::{Mapping, Presence};

fn main() -> ExitCode {
    let Some(path) = std::env::args().nth(1) else {
        eprintln!("points: expected the path of a mapping file");
        return ExitCode::from(2);
    };
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) => {
            eprintln!("{path}: {error}");
            return ExitCode::from(2);
        }
    };
    match Mapping::parse(&Source { name: path, text: text.into() }) {
        Ok(mapping) => {
            print(&mapping);
            ExitCode::SUCCESS
        }
        Err(found) => {
            found.diagnostics().iter().for_each(|one| eprintln!("{}: {}", one.place(), one.message()));
            ExitCode::FAILURE
        }
    }
}

fn print(mapping: &Mapping) {
    for (index, device) in mapping.devices.iter().enumerate() {
        let plan = &device.plan;
        println!("{} at {}, {}, watchdog {} ms", device.name, device.address, plan.kind, plan.watchdog_ms);
        for span in plan.reads.iter().chain(&plan.writes) {
            println!("  {} {:#06X}, {} of them", span.area, span.first, span.count);
        }
        let inputs = mapping.inputs.iter().filter(|point| point.device() == Some(index)).count();
        let outputs = mapping.outputs.iter().filter(|point| point.device() == index).count();
        println!("  {inputs} inputs, {outputs} outputs");
    }
    for presence in [Presence::Mapped, Presence::Fixed, Presence::Absent, Presence::Simulated] {
        let groups: Vec<&str> = mapping.groups(presence).map(|group| group.name()).collect();
        println!(
            "{}: {}",
            presence.name(),
            if groups.is_empty() { "none".to_owned() } else { groups.join(", ") }
        );
    }
}
