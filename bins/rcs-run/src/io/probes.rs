//! Sessions with all devices of a mapping, and the values of all inputs.

use std::{
    thread,
    time::{Duration, Instant},
};

use couplers::{Mode, Report};
use field::{InPoint, Mapping, Seen, Target};
use interfaces::DeviceInputs;

use super::{
    Bench, Obstacle, PERIOD, Probe,
    expected::{Work, work},
};

pub const NOISE: i64 = 16; // least difference of an input that is no switch, so that it has changed

/// Sessions with the devices, in their order; `None` for a device that is not ready.
pub struct Probes {
    probes: Vec<Option<Probe>>,
}

/// An input at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    pub raw: i64,
    /// Value in the controller; `None` for a point of the workstation.
    pub counts: Option<i64>,
}

impl Reading {
    /// Counts, or the raw value of a point without counts.
    pub fn value(self) -> i64 {
        self.counts.unwrap_or(self.raw)
    }
}

impl Probes {
    /// Sets up sessions that write no output. Also returns why devices are not ready.
    pub fn open(bench: &Bench) -> (Self, Vec<Option<Obstacle>>) {
        let opened = (0..bench.mapping.devices.len()).map(|index| match bench.probe(index, Mode::Watch) {
            Ok(probe) => (Some(probe), None),
            Err(hindrance) => (None, Some(hindrance)),
        });
        let (probes, hindrances) = opened.unzip();
        (Self { probes }, hindrances)
    }

    /// Exchanges data with all devices. Returns the durations.
    pub fn exchange(&mut self) -> Vec<Option<Duration>> {
        self.probes.iter_mut().map(|probe| probe.as_mut().map(Probe::exchange)).collect()
    }

    pub fn exchange_for(&mut self, time: Duration) {
        let begun = Instant::now();
        while begun.elapsed() < time {
            self.exchange();
            thread::sleep(PERIOD);
        }
    }

    pub fn get(&mut self, device: usize) -> Option<&mut Probe> {
        self.probes.get_mut(device)?.as_mut()
    }

    /// The values of all inputs; `None` for a fixed value, and for an input of a device that is not ready.
    pub fn read(&self, mapping: &Mapping) -> Vec<Option<Reading>> {
        let seen = |probe: &Option<Probe>| Seen {
            words: probe.as_ref().map_or(Report::STARTING.inputs, |probe| probe.report().inputs),
            age_ms: probe.as_ref().map(|_| 0),
            is_tripped: false,
        };
        let seen: Vec<Seen> = self.probes.iter().map(seen).collect();
        let mut inputs = DeviceInputs::default();
        mapping.apply(&seen, &mut inputs);
        let read = |point: &InPoint| {
            let device = point.device().filter(|device| self.probes[*device].is_some())?;
            let counts = match point.target {
                Target::Word(word) => Some(word.read(&inputs)),
                Target::Station => None,
            };
            Some(Reading { raw: point.raw(&seen[device].words)?, counts })
        };
        mapping.inputs.iter().map(read).collect()
    }

    pub fn end(self) {
        self.end_of(usize::MAX);
    }

    /// Ends all sessions. Returns true if this device has confirmed that its outputs are off.
    pub fn end_of(self, device: usize) -> bool {
        let ended =
            self.probes.into_iter().enumerate().filter_map(|(index, probe)| Some((index, probe?.end())));
        // All sessions are ended, also those after the device.
        ended.fold(false, |confirmed, (index, ended)| if index == device { ended } else { confirmed })
    }
}

/// True if an input has changed by more than its noise.
pub fn has_changed(point: &InPoint, noise: i64, before: Option<Reading>, now: Option<Reading>) -> bool {
    let (Some(before), Some(now)) = (before, now) else { return false };
    let noise = if work(point) == Work::Switch { 0 } else { noise.max(NOISE) };
    before.value().abs_diff(now.value()) > noise.unsigned_abs()
}

/// The inputs that have changed, by name.
pub fn changed(mapping: &Mapping, before: &[Option<Reading>], now: &[Option<Reading>]) -> Vec<String> {
    let readings = mapping.inputs.iter().zip(before.iter().zip(now));
    let changed = readings.filter(|(point, (before, now))| has_changed(point, 0, **before, **now));
    changed.map(|(point, _)| point.name.clone()).collect()
}
