//! Prints digests of two scenes with many contacts: `cargo run --release --example world_hash [SEED]`. The lines are
//! equal in every run and every build. `--ticks` prints the digest of every tick.

#![expect(clippy::print_stdout, reason = "figures are what it is for")]

#[path = "../tests/rig/mod.rs"]
mod rig;

use rig::{Rig, scenes};

type Scene = fn(u64) -> Rig;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let seed = words.iter().find_map(|word| word.parse().ok()).unwrap_or(1);
    let each = words.iter().any(|word| word == "--ticks");
    let scenes: [(&str, Scene); 2] = [("clamping", scenes::clamping), ("drumming", scenes::drumming)];
    for (name, scene) in scenes {
        let Some(tape) = scene(seed).tape else { continue };
        if each {
            for (tick, digest) in (1..).zip(&tape.digests) {
                println!("{name} {tick} {digest:016x}");
            }
        }
        println!("{name}, seed {seed}: {} ticks, {:016x}", tape.digests.len(), tape.chain());
    }
}
