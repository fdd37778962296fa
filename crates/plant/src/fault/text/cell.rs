//! Entries for faults of the cell.

use diagnostics::Problem;
use interfaces::point::{Input, Output};
use rcs_core::tick::TICK_S;

use super::{Entry, Value};
use crate::{
    description::CellDescription,
    fault::{DeliveryFault, Disorder, Fault, FaultSubject, When},
};

/// A kind of fault, and its keys except those for the time.
pub(super) struct Kind {
    name: &'static str,
    keys: &'static [&'static str],
    when: &'static [&'static str],
}

const LASTING: [&str; 6] = ["at", "from", "after", "until", "rate", "ticks"];
const DELIVERY: [&str; 5] = ["at", "from", "after", "until", "rate"];

const fn lasting(name: &'static str, keys: &'static [&'static str]) -> Kind {
    Kind { name, keys, when: &LASTING }
}

const fn delivery(name: &'static str, keys: &'static [&'static str]) -> Kind {
    Kind { name, keys, when: &DELIVERY }
}

const KINDS: [Kind; 16] = [
    lasting("off", &["sensor"]),
    lasting("stuck", &["sensor", "valve", "device", "value"]),
    lasting("noisy", &["sensor", "by"]),
    lasting("slow", &["sensor", "by"]),
    lasting("intermittent", &["sensor"]),
    lasting("offset", &["sensor", "by"]),
    lasting("drift", &["sensor", "by"]),
    lasting("air-lost", &[]),
    lasting("hydraulics-lost", &[]),
    lasting("camera-blind", &[]),
    lasting("field-cut", &["device"]),
    delivery("missing", &["object"]),
    delivery("misplaced", &["object", "x", "y"]),
    delivery("turned", &["object", "angle"]),
    delivery("wrong-part", &["object", "part"]),
    Kind { name: "pedestal-moved", keys: &["x", "y", "angle"], when: &[] },
];
const DEVICES: [&str; 2] = ["lock-ring", "vise-jaw"];
const MOST_TICKS: u32 = 100_000; // the longest duration of a fault with a rate, ticks
const MOST_LATE: f64 = 1000.0; // the longest delay of a sensor, ticks
const MOST_COUNTS: f64 = 100_000.0; // the greatest noise, offset or drift, counts
const MOST_ASIDE: f64 = 100.0;

impl Kind {
    pub(super) fn takes(&self) -> Vec<&'static str> {
        self.keys.iter().chain(self.when).copied().collect()
    }
}

pub(super) fn kinds() -> impl Iterator<Item = &'static str> {
    KINDS.iter().map(|kind| kind.name)
}

pub(super) fn kind(name: &str) -> Option<&'static Kind> {
    KINDS.iter().find(|kind| kind.name == name)
}

pub(super) fn fault(entry: &Entry<'_>, kind: &Kind, cell: &CellDescription) -> Result<Fault, Box<Problem>> {
    let what = what(entry, kind.name, cell)?;
    Ok(Fault { number: entry.number, what, when: when(entry)? })
}

fn what(entry: &Entry<'_>, kind: &str, cell: &CellDescription) -> Result<FaultSubject, Box<Problem>> {
    let form = entry.form;
    let by = |expected: &str, range: core::ops::RangeInclusive<f64>| {
        let by = form.by.ok_or_else(|| entry.says("needs `by`: how much"))?;
        entry.within("by", by, expected, range)
    };
    let aside = |key, value: Option<f64>| {
        entry.within(key, value.unwrap_or(0.0), "-100 to 100 in", -MOST_ASIDE..=MOST_ASIDE)
    };
    let angle = || entry.within("angle", form.angle.unwrap_or(0.0), "-360 to 360 degrees", -360.0..=360.0);
    let object = || form.object.as_ref().map(|object| part(entry, "object", object, cell)).transpose();
    let disorder = match kind {
        "off" | "intermittent" => Disorder::Off,
        "stuck" if form.sensor.is_none() => return stuck(entry),
        "stuck" => Disorder::Stuck(form.value.as_ref().map(|value| counts(entry, value)).transpose()?),
        "noisy" => Disorder::Noisy(by("counts, more than 0", f64::MIN_POSITIVE..=MOST_COUNTS)?),
        "slow" => Disorder::Slow(by("1 to 1000 ticks", 1.0..=MOST_LATE)? as u16),
        "offset" => Disorder::Offset(by("counts", -MOST_COUNTS..=MOST_COUNTS)?),
        "drift" => Disorder::Drift(by("counts a second", -MOST_COUNTS..=MOST_COUNTS)?),
        "air-lost" => return Ok(FaultSubject::AirLost),
        "hydraulics-lost" => return Ok(FaultSubject::HydraulicsLost),
        "camera-blind" => return Ok(FaultSubject::CameraBlind),
        "field-cut" => {
            let device =
                form.device.clone().ok_or_else(|| entry.says("needs `device`: which of the mapping"))?;
            return Ok(FaultSubject::FieldCut(device));
        }
        "missing" => return Ok(FaultSubject::Delivery(object()?, DeliveryFault::Missing)),
        "misplaced" => {
            let (x, y) = (aside("x", form.x)?, aside("y", form.y)?);
            return Ok(FaultSubject::Delivery(object()?, DeliveryFault::Misplaced { x, y }));
        }
        "turned" => {
            form.angle.ok_or_else(|| entry.says("needs `angle`: how far, degrees"))?;
            return Ok(FaultSubject::Delivery(object()?, DeliveryFault::Turned(angle()?)));
        }
        "wrong-part" => {
            let other =
                form.part.as_ref().ok_or_else(|| entry.says("needs `part`: what is delivered instead"))?;
            return Ok(FaultSubject::Delivery(
                object()?,
                DeliveryFault::WrongPart(part(entry, "part", other, cell)?),
            ));
        }
        _ => {
            let (x, y) = (aside("x", form.x)?, aside("y", form.y)?);
            return Ok(FaultSubject::PedestalMoved { x, y, angle: angle()? });
        }
    };
    let name = form.sensor.as_ref().ok_or_else(|| entry.says("needs `sensor`: which"))?;
    if form.valve.is_some() || form.device.is_some() {
        return Err(entry.says(ONE_OF));
    }
    let sensor = sensor(entry, name)?;
    if sensor.is_camera() && disorder != Disorder::Off {
        let message =
            "is for converters: the camera can be off or intermittent, and there is the kind camera-blind";
        return Err(entry.says(message));
    }
    Ok(FaultSubject::Sensor(sensor, disorder))
}

const ONE_OF: &str = "needs one of `sensor`, `valve` and `device`";

fn stuck(entry: &Entry<'_>) -> Result<FaultSubject, Box<Problem>> {
    let form = entry.form;
    match (&form.valve, &form.device) {
        (Some(valve), None) => {
            let known = || Output::valves().map(Output::name).collect::<Vec<_>>();
            let found = Output::valves().find(|known| known.name() == valve);
            let named = found.ok_or_else(|| entry.unknown("valve", valve, &known()))?;
            match &form.value {
                Some(Value::Word(word)) if word == "open" => Ok(FaultSubject::Valve(named, true)),
                Some(Value::Word(word)) if word == "closed" => Ok(FaultSubject::Valve(named, false)),
                Some(value) => Err(entry.unlike("value", "\"open\" or \"closed\"", value)),
                None => Err(entry.says("needs `value`: \"open\" or \"closed\" for a valve")),
            }
        }
        (None, Some(device)) => match device.as_str() {
            _ if form.value.is_some() => Err(entry.says("with a device takes no `value`")),
            "lock-ring" => Ok(FaultSubject::RingStuck),
            "vise-jaw" => Ok(FaultSubject::JawStuck),
            _ => Err(entry.unknown("device", device, &DEVICES)),
        },
        _ => Err(entry.says(ONE_OF)),
    }
}

fn sensor(entry: &Entry<'_>, name: &str) -> Result<Input, Box<Problem>> {
    let known = || Input::all().map(Input::name).collect::<Vec<_>>();
    Input::named(name).ok_or_else(|| entry.unknown("sensor", name, &known()))
}

fn part(entry: &Entry<'_>, key: &str, name: &str, cell: &CellDescription) -> Result<String, Box<Problem>> {
    let known = || cell.part.iter().map(|part| part.name.as_str()).collect::<Vec<_>>();
    let part = cell.part(name).ok_or_else(|| entry.unknown(key, name, &known()))?;
    Ok(part.name.clone())
}

fn counts(entry: &Entry<'_>, value: &Value) -> Result<i64, Box<Problem>> {
    let range = match &entry.form.sensor {
        Some(name) => sensor(entry, name)?.range(),
        None => 0..=0,
    };
    match value {
        Value::Count(count) if range.contains(count) => Ok(*count),
        found => Err(entry.unlike("value", format_args!("{} to {}", range.start(), range.end()), found)),
    }
}

fn when(entry: &Entry<'_>) -> Result<When, Box<Problem>> {
    let form = entry.form;
    let after = form.after.map(|after| entry.within("after", after, "seconds", 0.0..=1e5)).transpose()?;
    let after = after.map(|seconds| libm::round(seconds / TICK_S) as u64);
    let chance = |rate| entry.within("rate", rate, "a chance of 0.000001 to 1", 1e-6..=1.0);
    let rate = form.rate.map(chance).transpose()?;
    let ticks = form.ticks;
    if let Some(found) = ticks.filter(|ticks| !(1..=MOST_TICKS).contains(ticks)) {
        return Err(entry.unlike("ticks", format_args!("1 to {MOST_TICKS}"), found));
    }
    if form.kind == "intermittent" && rate.is_none() {
        return Err(entry.says("needs `rate`: the chance of failing in a tick"));
    }
    if [form.at, form.from, after].iter().flatten().count() > 1 {
        return Err(entry.says("has more than one of `at`, `from` and `after`"));
    }
    let length = ticks.map_or(1, u64::from);
    if let Some(at) = form.at {
        if form.until.is_some() {
            let message = "has `at`, which is one moment, and `until`: say with `ticks` how long it lasts";
            return Err(entry.says(message));
        }
        let until = at.saturating_add(if rate.is_some() { 1 } else { length });
        return Ok(When { from: at, until, rate, ticks: length });
    }
    if ticks.is_some() && rate.is_none() {
        let message =
            "has a range of ticks, which says how long it lasts: leave `ticks` out, or give a `rate`";
        return Err(entry.says(message));
    }
    let (from, until) = (form.from.or(after).unwrap_or(0), form.until.unwrap_or(u64::MAX));
    if from >= until {
        let message =
            format_args!("has no tick: expected `until` after the beginning, found {from} to {until}");
        return Err(entry.says(message));
    }
    Ok(When { from, until, rate, ticks: length })
}
