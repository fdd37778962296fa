//! A sample of the robustness campaign.

use std::process::{Child, Command, Stdio};

/// Garbage, dead readers, signals, full disk or memory.
const PARTS: [&str; 5] = ["logs", "memory", "readers", "signals", "disks"];

fn start(part: &str) -> Child {
    Command::new(env!("CARGO_BIN_EXE_robustness"))
        .args([part, "--sample"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the campaign can be started")
}

/// The parts run in parallel, as they mostly wait for runs in real time. Each prints its table.
#[test]
fn a_sample_of_each_part_has_no_finding() {
    let started = PARTS.map(|part| (part, start(part)));
    // All parts end before a failed one fails the test.
    let ended = started.map(|(part, child)| (part, child.wait_with_output().expect("the campaign ends")));
    for (part, output) in ended {
        assert!(output.status.success(), "{part}: {}", String::from_utf8_lossy(&output.stderr));
        println!("{}", String::from_utf8_lossy(&output.stdout));
    }
}
