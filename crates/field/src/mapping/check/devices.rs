//! The devices, and the images that their points make.

use std::net::SocketAddr;

use couplers::{Fallback, Kind, MOST_IN, MOST_OUT, OutWords, Plan, Span};
use diagnostics::{
    Problem, Problems,
    toml::{Defaulted, join},
};
use rcs_core::Plain as _;

use super::{
    super::{
        Device, InPoint, Origin, OutPoint,
        form::{DeviceForm, Sheet},
        place::Place,
    },
    says,
    spans::Taken,
    unlike,
};

/// Times between two exchanges, ms.
const EXCHANGE_MS: std::ops::RangeInclusive<u16> = 10..=1000;

/// Age after which the inputs of a device are stale, ms, unless a point has a lower limit.
const STALE_MS: u16 = 100;

pub(super) struct Devices {
    pub list: Vec<Device>,
    /// The names of all devices, also of those with mistakes.
    names: Vec<String>,
}

impl Devices {
    pub(super) fn of(sheet: &Sheet, stand_ins: &Defaulted, problems: &mut Problems) -> Self {
        let mut list: Vec<Device> = Vec::new();
        for (name, form) in &sheet.device {
            let path = join("device", name);
            if !stand_ins.trusts(&path) {
                continue;
            }
            match device(&path, name, form) {
                Ok(device) => {
                    let same = list
                        .iter()
                        .find(|other| (other.address, other.plan.unit) == (device.address, form.unit));
                    if let Some(other) = same {
                        let expected = format!("another address or unit than {}", other.name);
                        problems.add(unlike(
                            &join(&path, "address"),
                            expected,
                            format_args!("{:?}", form.address),
                        ));
                    }
                    list.push(device);
                }
                Err(problem) => problems.add(*problem),
            }
        }
        if sheet.device.is_empty() && stand_ins.trusts("device") {
            problems.add(unlike("device", "at least one [device.NAME]", "none"));
        }
        Self { list, names: sheet.device.keys().cloned().collect() }
    }

    /// The device with a name. `Ok(None)` for one whose own mistake is reported.
    pub(super) fn named(&self, path: &str, name: &str) -> Result<Option<usize>, Box<Problem>> {
        if let Some(index) = self.list.iter().position(|device| device.name == name) {
            return Ok(Some(index));
        }
        if self.names.iter().any(|known| known == name) {
            return Ok(None);
        }
        let known: Vec<&str> = self.names.iter().map(String::as_str).collect();
        let expected = format!("a device: one of {}", known.join(", "));
        Err(Box::new(unlike(path, expected, format_args!("{name:?}")).near(name, &known)))
    }

    /// Assigns images to the devices and words to the points.
    pub(super) fn lay_out(
        &mut self,
        read: &Taken,
        inputs: &mut [InPoint],
        written: &Taken,
        outputs: &mut [OutPoint],
        problems: &mut Problems,
    ) {
        for (index, device) in self.list.iter_mut().enumerate() {
            let path = join("device", &device.name);
            device.plan.reads = read.spans(index);
            device.plan.writes = written.spans(index);
            for (spans, most, what) in
                [(&device.plan.reads, MOST_IN, "read"), (&device.plan.writes, MOST_OUT, "written")]
            {
                let words: usize = spans.iter().map(Span::words).sum();
                if words > most {
                    let expected = format!(
                        "points within {most} registers that one request can have {what}, from the first to the last"
                    );
                    problems.add(unlike(&path, expected, format_args!("{words} registers")));
                    return;
                }
            }
        }
        for point in inputs {
            let Origin::Slot(slot) = &mut point.from else { continue };
            if let Some(device) = self.list.get_mut(slot.device) {
                read.place(&point.name, &device.plan.reads, slot);
                device.plan.stale_ms = device.plan.stale_ms.min(point.stale_ms);
            }
        }
        for point in outputs.iter_mut() {
            if let Some(device) = self.list.get_mut(point.slot.device) {
                written.place(&point.name, &device.plan.writes, &mut point.slot);
                point.slot.put(&mut device.plan.safe.words, point.safe);
                if point.rest {
                    point.slot.mark(&mut device.plan.rest.words);
                }
            }
        }
        if !problems.is_empty() {
            return;
        }
        for (index, device) in self.list.iter_mut().enumerate() {
            if device.plan.fallback == Fallback::Hold {
                // Bits without a point are never on.
                let mut mapped = OutWords::ZERO;
                let own = outputs.iter().filter(|point| point.slot.device == index);
                own.for_each(|point| point.slot.mark(&mut mapped.words));
                let free = device.plan.written().outside(&mapped);
                device.plan.rest = device.plan.rest.with(&free, |rest, free| rest | free);
            }
            if let Err(error) = device.plan.check() {
                problems.add(says(&join("device", &device.name), error));
            }
        }
    }
}

fn device(path: &str, name: &str, form: &DeviceForm) -> Result<Device, Box<Problem>> {
    let at = |key: &str| join(path, key);
    let word = |key: &str, found: &str, known: &[&str]| {
        let expected = format!("one of {}", known.join(", "));
        Box::new(unlike(&at(key), expected, format_args!("{found:?}")).near(found, known))
    };
    let address: SocketAddr = form.address.parse().map_err(|_| {
        let expected = "a numeric address with a port, such as \"192.168.10.20:502\"";
        Box::new(unlike(&at("address"), expected, format_args!("{:?}", form.address)))
    })?;
    let kinds: Vec<&str> = Kind::ALL.iter().map(|kind| kind.text()).collect();
    let kind = Kind::from_text(&form.kind).ok_or_else(|| word("kind", &form.kind, &kinds))?;
    let can: Vec<&str> = kind.facts().fallbacks.iter().map(|fallback| fallback.text()).collect();
    let fallback =
        Fallback::from_text(&form.fallback).filter(|fallback| kind.facts().fallbacks.contains(fallback));
    let fallback = fallback.ok_or_else(|| {
        let expected = format!("what kind {} can do, {}", kind.text(), can.join(" or "));
        Box::new(unlike(&at("fallback"), expected, format_args!("{:?}", form.fallback)))
    })?;
    let watchdog_ms = watchdog(&at("watchdog_ms"), kind, form)?;
    let alive = form.alive.as_deref().map(|text| alive(&at("alive"), name, text)).transpose()?;
    if !EXCHANGE_MS.contains(&form.exchange_ms) {
        return Err(Box::new(unlike(&at("exchange_ms"), "10 to 1000 ms", form.exchange_ms)));
    }
    if !(1..form.exchange_ms).contains(&form.timeout_ms) {
        let expected = format!("1 ms to less than exchange_ms, {} ms", form.exchange_ms);
        return Err(Box::new(unlike(&at("timeout_ms"), expected, form.timeout_ms)));
    }
    let plan = Plan {
        unit: form.unit,
        kind,
        fallback,
        watchdog_ms,
        stale_ms: STALE_MS,
        reads: Vec::new(),
        writes: Vec::new(),
        safe: OutWords::ZERO,
        rest: OutWords::ZERO,
        alive,
    };
    let (exchange_ms, timeout_ms) = (form.exchange_ms, form.timeout_ms);
    Ok(Device { name: name.to_owned(), address, exchange_ms, timeout_ms, plan })
}

/// The register that the program of a device increments.
fn alive(path: &str, name: &str, text: &str) -> Result<Span, Box<Problem>> {
    let place = format!("{name} {text}");
    let found = Place::parse(&place).ok().filter(|place| !place.area.has_bits() && place.bit.is_none());
    let place = found.ok_or_else(|| {
        let expected = "a register that the program of the device increments, such as \"input 40\"";
        Box::new(unlike(path, expected, format_args!("{text:?}")))
    })?;
    Ok(Span { area: place.area, first: place.address, count: 1 })
}

/// The time of the watchdog; 0 if the kind has none.
fn watchdog(path: &str, kind: Kind, form: &DeviceForm) -> Result<u16, Box<Problem>> {
    let name = kind.text();
    let Some(watchdog) = &kind.facts().watchdog else {
        return form.watchdog_ms.map_or(Ok(0), |found| {
            Err(Box::new(unlike(path, format_args!("no watchdog_ms: kind {name} has no watchdog"), found)))
        });
    };
    let (times, step) = (&watchdog.times_ms, watchdog.step_ms);
    let multiple = if step > 1 { format!(", a multiple of {step}") } else { String::new() };
    let expected = format!(
        "the time of the watchdog, {} to {} ms{multiple} for kind {name}",
        times.start(),
        times.end()
    );
    match form.watchdog_ms {
        Some(found) if times.contains(&found) && found % step == 0 => Ok(found),
        Some(found) => Err(Box::new(unlike(path, expected, found))),
        None => Err(Box::new(unlike(path, expected, "none"))),
    }
}
