//! Tests outputs one at a time: each is switched on after a question, read back, and switched off.

use std::{
    io,
    sync::atomic::{AtomicBool, Ordering},
    time::Duration,
};

use couplers::Mode;
use os_io::stderr_line;

use super::{
    Bench,
    person::Person,
    probes::{Probes, Reading, changed},
    tally::{OutputTally, Verdict},
    test::is_selected,
};
use crate::rcs_run::error::Error;

const ON_FOR: Duration = Duration::from_secs(1);
const OFF_FOR: Duration = Duration::from_millis(100);
/// Parts of names of outputs that open, release or start something.
const RISKY: [&str; 6] = ["open", "unlock", "release", "vent", "start", "order"];
const UNLOCK: &str = "quick-change.unlock";
const SEATED: [&str; 2] = [".small-1", ".small-2"]; // the sensors of a holster that detect a seated gripper (V.1.2)
const ID: &str = "quick-change.id.";

/// Refuses the test while an output is on: a gripper or a vise that is closed may hold a part.
pub fn check_nothing_held(bench: &Bench, ready: &[usize]) -> Result<(), Error> {
    for index in ready {
        let Ok(probe) = bench.probe(*index, Mode::Watch) else { continue };
        let image = probe.report().acknowledged;
        probe.end();
        let of_device = bench.mapping.outputs.iter().filter(|point| point.device() == *index);
        let closes = of_device.filter(|point| point.name.ends_with("close") || point.name.ends_with("grip"));
        let on: Vec<&str> =
            closes.filter(|point| point.get(&image) != point.safe).map(|point| point.name.as_str()).collect();
        if !on.is_empty() {
            return Err(Error::Field(format!(
                "no output is written: {} on, and may hold something. Take it, and switch the device off and on",
                on.join(", ")
            )));
        }
    }
    Ok(())
}

pub fn test(
    bench: &Bench,
    index: usize,
    selected: &[String],
    person: &Person,
    stop: &AtomicBool,
) -> io::Result<Vec<OutputTally>> {
    let mut tallies = Vec::new();
    let of_device = bench.mapping.outputs.iter().filter(|point| point.device() == index);
    for point in of_device.filter(|point| is_selected(&point.name, selected)) {
        let mut tally = OutputTally {
            name: point.name.clone(),
            device: bench.mapping.devices[index].name.clone(),
            changed: Vec::new(),
            verdict: Verdict::Skipped,
            note: String::new(),
        };
        if RISKY.iter().any(|part| point.name.contains(part)) {
            stderr_line!("{}: it may open, release or start something. Keep clear.", point.name);
        }
        let is_asked =
            !stop.load(Ordering::Relaxed) && person.ask(&format!("{}: on for a second?", point.name))?;
        if is_asked {
            pulse(bench, index, point, person, &mut tally)?;
        }
        tallies.push(tally);
    }
    Ok(tallies)
}

fn pulse(
    bench: &Bench,
    index: usize,
    point: &field::OutPoint,
    person: &Person,
    tally: &mut OutputTally,
) -> io::Result<()> {
    let (mut probes, mut hindrances) = Probes::open(bench);
    if let Some(hindrance) = hindrances.get_mut(index).and_then(Option::take) {
        (tally.verdict, tally.note) = (Verdict::NotReady, hindrance.text);
        return Ok(());
    }
    probes.exchange();
    let before = probes.read(&bench.mapping);
    if point.name == UNLOCK
        && let Some(why) = would_drop(bench, &before)
    {
        probes.end();
        (tally.verdict, tally.note) = (Verdict::Refused, why);
        return Ok(());
    }
    let Some(probe) = probes.get(index) else { return Ok(()) };
    let left = probe.report().acknowledged;
    (probe.orders.mode, probe.orders.words) = (Mode::Run, left);
    point.set(i64::from(point.safe == 0), &mut probe.orders.words);
    let asked = probe.orders.words;
    probes.exchange_for(ON_FOR);
    let after = probes.read(&bench.mapping);
    tally.changed = changed(&bench.mapping, &before, &after);
    let Some(probe) = probes.get(index) else { return Ok(()) };
    let is_read_back = probe.report().acknowledged == asked;
    probe.orders.words = left;
    probe.exchange_for(OFF_FOR);
    let is_off = probe.report().acknowledged == left;
    if !(probes.end_of(index) && is_off) {
        tally.note = "it was not confirmed that it is off again: look at the device".to_owned();
        stderr_line!("{}: {}", point.name, tally.note);
        tally.verdict = Verdict::NoEffect;
        return Ok(());
    }
    if !tally.changed.is_empty() {
        stderr_line!("{}: changed {}", point.name, tally.changed.join(", "));
    }
    let is_seen = is_read_back && person.ask(&format!("{}: did it work?", point.name))?;
    tally.verdict = if is_seen { Verdict::Good } else { Verdict::NoEffect };
    Ok(())
}

/// Why the ring may not be unlocked: a gripper is on the robot, and some holster has no seated gripper. `None` if no
/// gripper is on the robot, if all are seated, or if no sensor shows it.
fn would_drop(bench: &Bench, readings: &[Option<Reading>]) -> Option<String> {
    let value = |reading: &Option<Reading>| reading.map_or(0, Reading::value);
    let points = || bench.mapping.inputs.iter().zip(readings);
    let has_gripper = points().any(|(point, reading)| point.name.starts_with(ID) && value(reading) != 0);
    let seats = |name: &str| name.starts_with("holster.") && SEATED.iter().any(|end| name.ends_with(end));
    let empty = points().find(|(point, reading)| seats(&point.name) && value(reading) == 0);
    let (empty, _) = empty.filter(|_| has_gripper)?;
    Some(format!("{} is 0: the gripper on the robot may not be in its holster, and would fall", empty.name))
}
