//! Tests outputs one at a time: each is switched on after a question, read back, and switched off.

use std::{
    io,
    sync::atomic::{AtomicBool, Ordering},
    time::Duration,
};

use couplers::Mode;
use os_io::stderr_line;

use super::{
    Bench, Hindrance, ask,
    tally::{OutputTally, Verdict},
};

const ON_FOR: Duration = Duration::from_secs(1);
const OFF_FOR: Duration = Duration::from_millis(100);
/// Parts of names of outputs that open, release or start something.
const RISKY: [&str; 6] = ["open", "unlock", "release", "vent", "start", "order"];

pub fn test(bench: &Bench, index: usize, stop: &AtomicBool) -> io::Result<Vec<OutputTally>> {
    let mut tallies = Vec::new();
    for point in bench.mapping.outputs.iter().filter(|point| point.device() == index) {
        let device = &bench.mapping.devices[index].name;
        if RISKY.iter().any(|part| point.name.contains(part)) {
            stderr_line!("{}: it may open, release or start something. Keep clear.", point.name);
        }
        let is_asked = !stop.load(Ordering::Relaxed) && ask(&format!("{}: on for a second?", point.name))?;
        let verdict = if is_asked { pulse(bench, index, point)? } else { Verdict::Skipped };
        tallies.push(OutputTally { name: point.name.clone(), device: device.clone(), verdict });
    }
    Ok(tallies)
}

fn pulse(bench: &Bench, index: usize, point: &field::OutPoint) -> io::Result<Verdict> {
    let mut probe = match bench.probe(index, Mode::Watch) {
        Ok(probe) => probe,
        Err(Hindrance { text, .. }) => {
            stderr_line!("{text}");
            return Ok(Verdict::NotReady);
        }
    };
    let before = probe.report().acknowledged;
    (probe.orders.mode, probe.orders.words) = (Mode::Run, before);
    point.set(i64::from(point.safe == 0), &mut probe.orders.words);
    let asked = probe.orders.words;
    probe.exchange_for(ON_FOR);
    let is_read_back = probe.report().acknowledged == asked;
    probe.orders.words = before;
    probe.exchange_for(OFF_FOR);
    let is_off = probe.report().acknowledged == before;
    if !(probe.end() && is_off) {
        stderr_line!("{}: it was not confirmed that it is off again: look at the device", point.name);
        return Ok(Verdict::NoEffect);
    }
    let is_seen = is_read_back && ask(&format!("{}: did it work?", point.name))?;
    Ok(if is_seen { Verdict::Good } else { Verdict::NoEffect })
}
