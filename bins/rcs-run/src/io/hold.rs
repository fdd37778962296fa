//! Tests whether a gripper keeps a part while nobody writes its outputs.
//!
//! The gripper closes on a part. Then the program is silent, as a controller that has lost its power: the watchdog of
//! the device makes the outputs safe. Opening and force are compared before and after, and the person looks.

use std::{
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

use couplers::Mode;
use os_io::stderr_line;

use super::{
    Bench, Probe,
    person::Person,
    tally::{HoldReading, HoldTally, Verdict},
};
use crate::rcs_run::error::Error;

const CLOSING: Duration = Duration::from_secs(4); // for any travel, and until the full force is there
const SILENT: Duration = Duration::from_secs(10);
const AVERAGED: u32 = 25; // readings of a sensor
const SLIPPED: i64 = 30; // counts of a potentiometer: 0.05 in
const WEAKER: i64 = 10; // the force may fall by one part in so many

/// A gripper: its name, the outputs that close it, and its sensors.
struct Gripper {
    name: &'static str,
    closes: &'static [&'static str],
    opening: &'static str,
    forces: &'static [&'static str],
}

const GRIPPERS: [Gripper; 4] = [
    Gripper {
        name: "grip",
        closes: &["grip.supply", "grip.close-coarse"],
        opening: "grip.potentiometer",
        forces: &["grip.strain-left", "grip.strain-right"],
    },
    Gripper { name: "v", closes: &["v.close"], opening: "grip.potentiometer", forces: &[] },
    Gripper { name: "tool", closes: &["tool.close"], opening: "grip.potentiometer", forces: &[] },
    Gripper {
        name: "pedestal",
        closes: &["pedestal.supply", "pedestal.close-coarse"],
        opening: "pedestal.potentiometer",
        forces: &["pedestal.strain-left", "pedestal.strain-right"],
    },
];

/// Fails if the mapping has no such gripper, its device is not ready, or the person says no. Nothing is written then.
pub fn test(bench: &Bench, name: &str, person: &Person, stop: &AtomicBool) -> Result<HoldTally, Error> {
    let (gripper, device) = find(bench, name)?;
    stderr_line!("{name} closes now, and its outputs are switched off after {} s.", CLOSING.as_secs());
    stderr_line!(
        "The robot must be switched off. Support a part between the open fingers, not with your hands."
    );
    if !person.ask("Is it so?")? {
        return Err(Error::Field("no output is written".to_owned()));
    }
    let mut probe = bench.probe(device, Mode::Watch).map_err(|hindrance| Error::Field(hindrance.text))?;
    let open = read(bench, gripper, device, &mut probe);
    (probe.orders.mode, probe.orders.words) = (Mode::Run, probe.report().acknowledged);
    for point in bench.mapping.outputs.iter().filter(|point| gripper.closes.contains(&point.name.as_str())) {
        point.set(i64::from(point.safe == 0), &mut probe.orders.words);
    }
    let asked = probe.orders.words;
    probe.exchange_for(CLOSING);
    let is_written = probe.report().acknowledged == asked;
    let held = read(bench, gripper, device, &mut probe);
    stderr_line!("Nothing is written for {} s.", SILENT.as_secs());
    // Dropping the session resets its connection.
    drop(probe);
    let begun = Instant::now();
    while begun.elapsed() < SILENT && !stop.load(Ordering::Relaxed) {
        thread::sleep(Duration::from_millis(100));
    }
    let mut probe = bench.probe(device, Mode::Watch).map_err(|hindrance| Error::Field(hindrance.text))?;
    let after = read(bench, gripper, device, &mut probe);
    // A device without a watchdog still has its outputs on, so they are switched off now.
    probe.orders.mode = Mode::Safe;
    probe.exchange_for(Duration::from_millis(200));
    let is_off = probe.end();
    let readings: Vec<HoldReading> = open
        .into_iter()
        .zip(held.into_iter().zip(after))
        .map(|((name, open), ((_, held), (_, after)))| HoldReading { name, open, held, after })
        .collect();
    let note = if !is_written {
        Some("the outputs that close it were not acknowledged".to_owned())
    } else if !is_off {
        Some("it was not confirmed that its outputs are off: look at the device".to_owned())
    } else if !person.ask("Is the part still held?")? {
        Some("the person says so".to_owned())
    } else {
        loss(gripper, &readings)
    };
    let verdict = if note.is_some() { Verdict::NotHeld } else { Verdict::Good };
    Ok(HoldTally {
        gripper: name.to_owned(),
        silent_s: SILENT.as_secs(),
        readings,
        verdict,
        note: note.unwrap_or_default(),
    })
}

fn find(bench: &Bench, name: &str) -> Result<(&'static Gripper, usize), Error> {
    let Some(gripper) = GRIPPERS.iter().find(|gripper| gripper.name == name) else {
        let known: Vec<&str> = GRIPPERS.iter().map(|gripper| gripper.name).collect();
        return Err(Error::Field(format!("--hold {name}: expected one of {}", known.join(", "))));
    };
    let mut devices = gripper.closes.iter().map(|close| {
        let point = bench.mapping.outputs.iter().find(|point| point.name == *close);
        point.map(field::OutPoint::device)
    });
    let first = devices.next().flatten();
    match first {
        Some(device) if devices.all(|other| other == first) => Ok((gripper, device)),
        _ => Err(Error::Field(format!(
            "--hold {name}: the mapping needs {} on one device",
            gripper.closes.join(" and ")
        ))),
    }
}

/// Mean counts of the sensors of a gripper that are on its device.
fn read(bench: &Bench, gripper: &Gripper, device: usize, probe: &mut Probe) -> Vec<(String, i64)> {
    let names = [gripper.opening].into_iter().chain(gripper.forces.iter().copied());
    let points = names.filter_map(|name| bench.mapping.inputs.iter().find(|point| point.name == name));
    let points: Vec<_> = points.filter(|point| point.device() == Some(device)).collect();
    let mut sums = vec![0; points.len()];
    for _ in 0..AVERAGED {
        probe.exchange_for(Duration::from_millis(1));
        for (sum, point) in sums.iter_mut().zip(&points) {
            let raw = point.raw(&probe.report().inputs).unwrap_or_default();
            *sum += point.line().map_or(raw, |line| line.counts(raw, None));
        }
    }
    let means = sums.into_iter().map(|sum| sum / i64::from(AVERAGED));
    points.into_iter().map(|point| point.name.clone()).zip(means).collect()
}

/// What the sensors of a gripper show of a loss; `None` if nothing.
fn loss(gripper: &Gripper, readings: &[HoldReading]) -> Option<String> {
    readings.iter().find_map(|HoldReading { name, open, held, after }| {
        let change = after - held;
        if name == gripper.opening {
            return (change.abs() > SLIPPED).then(|| format!("{name} has changed by {change} counts"));
        }
        let (force, lost) = (held - open, held - after);
        (lost * WEAKER > force && lost > SLIPPED)
            .then(|| format!("{name} has lost {lost} of {force} counts of force"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reading(name: &str, open: i64, held: i64, after: i64) -> HoldReading {
        HoldReading { name: name.to_owned(), open, held, after }
    }

    #[test]
    fn loss_of_force_and_slip_are_named() {
        let [grip, ..] = &GRIPPERS;
        let readings = |opening: i64, force: i64| {
            [reading("grip.potentiometer", 2300, 800, opening), reading("grip.strain-left", 310, 2310, force)]
        };
        assert_eq!(loss(grip, &readings(810, 2200)), None);
        assert_eq!(loss(grip, &readings(840, 2200)).unwrap(), "grip.potentiometer has changed by 40 counts");
        let weaker = loss(grip, &readings(800, 2100)).unwrap();
        assert_eq!(weaker, "grip.strain-left has lost 210 of 2000 counts of force");
    }
}
