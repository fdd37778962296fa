//! Faults of the cell as files: the same TOML that has the faults of the line ([`depc::fault::text`]).
//!
//! ```toml
//! seed = 7                        # one for all faults of the file, and the run's beside it; 1 if it is not given
//!
//! [[fault]]
//! kind = "stuck"                  # off stuck noisy slow intermittent offset drift: a sensor
//! sensor = "grip.potentiometer"
//! value = 900                     # stuck: at this count; at the present one if it is not given
//! from = 200                      # first tick, or after = 8.0 seconds ...
//! until = 500                     # ... and the tick behind the last; or at = 200, and ticks = 300
//!
//! [[fault]]
//! kind = "noisy"                  # by: counts (noisy, offset), counts a second (drift), ticks of delay (slow)
//! sensor = "force.z"
//! by = 40
//! rate = 0.01                     # chance of beginning in each tick; it then lasts `ticks` ticks, 1 if not given
//! ticks = 25
//!
//! [[fault]]
//! kind = "stuck"                  # a valve
//! valve = "grip.close-medium"
//! value = "closed"                # or "open"
//!
//! [[fault]]
//! kind = "wrong-part"             # missing misplaced turned wrong-part: a delivery to a tray
//! object = "LINKBAR1_BH"          # of this part; of any if it is not given
//! part = "LCLEVIS_BH"
//! ```
//!
//! Others: `stuck` with `device = "lock-ring"` or `"vise-jaw"`, `air-lost`, `hydraulics-lost`,
//! `camera-blind`, `pedestal-moved`. A fault that does not say when is there all the time.

use std::path::Path;

use depc::fault::{
    Plan,
    text::{Entry, Sheet},
};
use os_io::files;
use rcs_core::tick::TICK_S;
use serde::Deserialize;
use toml::{Spanned, Value};

pub use super::problem::{FaultFileError, Problem};
use super::{Disorder, Fault, FaultPlan, Mishap, Valve, What, When};
use crate::{description::CellDescription, sensor::Sensor};

/// A file of faults.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FaultFile {
    /// Faults of the line to the robot controller, if there are any.
    pub line: Option<Plan>,
    /// Faults of the cell.
    pub cell: FaultPlan,
}

/// A kind: its name, and the keys that it takes beside those that say when.
type Kind = (&'static str, &'static [&'static str]);

/// Kinds of faults of the cell.
const KINDS: [Kind; 15] = [
    ("off", &["sensor"]),
    ("stuck", &["sensor", "valve", "device", "value"]),
    ("noisy", &["sensor", "by"]),
    ("slow", &["sensor", "by"]),
    ("intermittent", &["sensor"]),
    ("offset", &["sensor", "by"]),
    ("drift", &["sensor", "by"]),
    ("air-lost", &[]),
    ("hydraulics-lost", &[]),
    ("camera-blind", &[]),
    ("missing", &["object"]),
    ("misplaced", &["object", "x", "y"]),
    ("turned", &["object", "angle"]),
    ("wrong-part", &["object", "part"]),
    ("pedestal-moved", &["x", "y", "angle"]),
];
/// Keys that say when, of a fault that lasts.
const WHEN: [&str; 6] = ["at", "from", "after", "until", "rate", "ticks"];
/// Devices that can be stuck, beside sensors and valves.
const DEVICES: [&str; 2] = ["lock-ring", "vise-jaw"];
/// The longest time of a fault with a rate, and the longest delay, ticks.
const MOST_TICKS: i64 = 100_000;
/// The longest delay of a sensor, ticks.
const MOST_LATE: f64 = 1000.0;
/// The greatest noise, offset or drift, counts: beyond every converter.
const MOST_COUNTS: f64 = 200_000.0;
/// The greatest displacement, in.
const MOST_ASIDE: f64 = 100.0;

/// All keys with their types.
#[derive(Deserialize)]
struct Form {
    sensor: Option<Spanned<String>>,
    valve: Option<Spanned<String>>,
    device: Option<Spanned<String>>,
    value: Option<Spanned<Value>>,
    by: Option<Spanned<f64>>,
    object: Option<Spanned<String>>,
    part: Option<Spanned<String>>,
    x: Option<Spanned<f64>>,
    y: Option<Spanned<f64>>,
    angle: Option<Spanned<f64>>,
    at: Option<Spanned<i64>>,
    from: Option<Spanned<i64>>,
    after: Option<Spanned<f64>>,
    until: Option<Spanned<i64>>,
    rate: Option<Spanned<f64>>,
    ticks: Option<Spanned<i64>>,
}

/// What is wrong, and where if that is not the whole fault.
type Wrong = (Problem, Option<usize>);

/// Read a file of faults for a cell.
///
/// # Errors
/// [`FaultFileError`] with the file, the line, what was expected and what was found.
pub fn load(path: &Path, cell: &CellDescription) -> Result<FaultFile, FaultFileError> {
    let file = path.display().to_string();
    match files::read_text(path) {
        Ok(text) => parse(&file, &text, cell),
        Err(source) => Err(FaultFileError::Read { file, source }),
    }
}

/// The faults in `text` for a cell; `file` names it in errors.
///
/// # Errors
/// [`FaultFileError`] with the file, the line, what was expected and what was found.
pub fn parse(file: &str, text: &str, cell: &CellDescription) -> Result<FaultFile, FaultFileError> {
    let sheet = Sheet::read(file, text)?;
    let mut plan = FaultPlan { seed: sheet.seed(), faults: Vec::new() };
    for entry in sheet.entries().iter().filter(|entry| !entry.is_of_line()) {
        let fault = fault(entry, cell).map_err(|(problem, place)| FaultFileError::Fault {
            file: file.into(),
            line: sheet.line(place.unwrap_or_else(|| entry.place())),
            number: entry.number,
            problem,
        })?;
        plan.faults.push(fault);
    }
    let of_line = sheet.entries().iter().any(Entry::is_of_line);
    let line = of_line.then(|| sheet.plan(|entry| entry.is_of_line())).transpose()?;
    Ok(FaultFile { line, cell: plan })
}

/// The fault of an entry.
fn fault(entry: &Entry<'_>, cell: &CellDescription) -> Result<Fault, Wrong> {
    let found = entry.kind.get_ref();
    let kind = KINDS.iter().find(|(known, _)| known == found).ok_or_else(|| {
        let line = depc::fault::FaultKind::ALL.iter().map(|kind| kind.text());
        let known = KINDS.iter().map(|(kind, _)| *kind).chain(line).collect();
        let problem = Problem::Unknown { what: "kind of fault", found: found.clone(), known };
        (problem, Some(entry.kind.span().start))
    })?;
    let (name, own) = kind;
    let when = match *name {
        "pedestal-moved" => &[][..],
        "missing" | "misplaced" | "turned" | "wrong-part" => &WHEN[..5],
        _ => &WHEN[..],
    };
    let takes: Vec<&'static str> = ["kind"].iter().chain(*own).chain(when).copied().collect();
    if let Some((key, place)) = entry.keys().find(|(key, _)| !takes.contains(key)) {
        return Err((Problem::Key { kind: name, key: key.into(), takes }, Some(place)));
    }
    let form: Form = entry
        .read()
        .map_err(|error| (Problem::Type(error.message().into()), error.span().map(|span| span.start)))?;
    let what = what(name, &form, cell)?;
    Ok(Fault { number: entry.number, when: self::when(name, &form)?, what })
}

/// What happens.
fn what(kind: &'static str, form: &Form, cell: &CellDescription) -> Result<What, Wrong> {
    let needs = |needs| (Problem::Needs { kind, needs }, None);
    let by = |expected: &str, range: core::ops::RangeInclusive<f64>| {
        let by = form.by.as_ref().ok_or_else(|| needs("`by`: how much"))?;
        within("by", by, expected, range)
    };
    let aside = |key, value: &Option<Spanned<f64>>| match value {
        Some(value) => within(key, value, "-100 to 100 in", -MOST_ASIDE..=MOST_ASIDE),
        None => Ok(0.0),
    };
    let angle = || match &form.angle {
        Some(angle) => within("angle", angle, "-360 to 360 degrees", -360.0..=360.0),
        None => Ok(0.0),
    };
    let object = || form.object.as_ref().map(|object| part(object, cell)).transpose();
    let disorder = match kind {
        "off" | "intermittent" => Disorder::Off,
        "stuck" if form.sensor.is_none() => return stuck(kind, form),
        "stuck" => Disorder::Stuck(form.value.as_ref().map(|value| counts(form, value)).transpose()?),
        "noisy" => Disorder::Noisy(by("counts, more than 0", f64::MIN_POSITIVE..=MOST_COUNTS)?),
        "slow" => Disorder::Slow(by("1 to 1000 ticks", 1.0..=MOST_LATE)? as u16),
        "offset" => Disorder::Offset(by("counts", -MOST_COUNTS..=MOST_COUNTS)?),
        "drift" => Disorder::Drift(by("counts a second", -MOST_COUNTS..=MOST_COUNTS)?),
        "air-lost" => return Ok(What::AirLost),
        "hydraulics-lost" => return Ok(What::HydraulicsLost),
        "camera-blind" => return Ok(What::CameraBlind),
        "missing" => return Ok(What::Delivery(object()?, Mishap::Missing)),
        "misplaced" => {
            let (x, y) = (aside("x", &form.x)?, aside("y", &form.y)?);
            return Ok(What::Delivery(object()?, Mishap::Misplaced { x, y }));
        }
        "turned" => {
            form.angle.as_ref().ok_or_else(|| needs("`angle`: how far, degrees"))?;
            return Ok(What::Delivery(object()?, Mishap::Turned(angle()?)));
        }
        "wrong-part" => {
            let other = form.part.as_ref().ok_or_else(|| needs("`part`: what comes instead"))?;
            return Ok(What::Delivery(object()?, Mishap::WrongPart(part(other, cell)?)));
        }
        _ => {
            let (x, y) = (aside("x", &form.x)?, aside("y", &form.y)?);
            return Ok(What::PedestalMoved { x, y, angle: angle()? });
        }
    };
    let name = form.sensor.as_ref().ok_or_else(|| needs("`sensor`: which"))?;
    if form.valve.is_some() || form.device.is_some() {
        return Err(needs("one of `sensor`, `valve` and `device`"));
    }
    let sensor = sensor(name)?;
    if sensor.is_camera() && disorder != Disorder::Off {
        return Err((Problem::Camera, Some(name.span().start)));
    }
    Ok(What::Sensor(sensor, disorder))
}

/// What is stuck, if it is no sensor.
fn stuck(kind: &'static str, form: &Form) -> Result<What, Wrong> {
    match (&form.valve, &form.device) {
        (Some(valve), None) => {
            let named = Valve::named(valve.get_ref())
                .ok_or_else(|| unknown("valve", valve, Valve::all().map(Valve::name).collect()))?;
            let expected = || "\"open\" or \"closed\"".to_owned();
            let value = form.value.as_ref();
            match value.map(|value| (value.get_ref().as_str(), value)) {
                Some((Some("open"), _)) => Ok(What::Valve(named, true)),
                Some((Some("closed"), _)) => Ok(What::Valve(named, false)),
                Some((_, value)) => {
                    let found = value.get_ref().to_string();
                    let problem = Problem::Value { key: "value", expected: expected(), found };
                    Err((problem, Some(value.span().start)))
                }
                None => {
                    Err((Problem::Needs { kind, needs: "`value`: \"open\" or \"closed\" for a valve" }, None))
                }
            }
        }
        (None, Some(device)) => match device.get_ref().as_str() {
            _ if form.value.is_some() => {
                let takes = vec!["kind", "device"];
                Err((Problem::Key { kind: "stuck with a device", key: "value".into(), takes }, None))
            }
            "lock-ring" => Ok(What::RingStuck),
            "vise-jaw" => Ok(What::JawStuck),
            _ => Err(unknown("device", device, DEVICES.to_vec())),
        },
        _ => Err((Problem::Needs { kind, needs: "one of `sensor`, `valve` and `device`" }, None)),
    }
}

fn unknown(what: &'static str, found: &Spanned<String>, known: Vec<&'static str>) -> Wrong {
    let problem = Problem::Unknown { what, found: found.get_ref().clone(), known };
    (problem, Some(found.span().start))
}

fn sensor(name: &Spanned<String>) -> Result<Sensor, Wrong> {
    Sensor::named(name.get_ref())
        .ok_or_else(|| unknown("sensor", name, Sensor::all().map(Sensor::name).collect()))
}

fn part(name: &Spanned<String>, cell: &CellDescription) -> Result<String, Wrong> {
    match cell.part(name.get_ref()) {
        Some(part) => Ok(part.name.clone()),
        None => {
            let known = cell.part.iter().map(|part| part.name.as_str()).collect::<Vec<_>>().join(", ");
            let problem = Problem::UnknownPart { found: name.get_ref().clone(), known };
            Err((problem, Some(name.span().start)))
        }
    }
}

/// The count at which a sensor is stuck.
fn counts(form: &Form, value: &Spanned<Value>) -> Result<i64, Wrong> {
    let range = match &form.sensor {
        Some(name) => sensor(name)?.range(),
        None => 0..=0,
    };
    let found = value.get_ref().as_integer().filter(|found| range.contains(found));
    found.ok_or_else(|| {
        let expected = format!("{} to {}", range.start(), range.end());
        let problem = Problem::Value { key: "value", expected, found: value.get_ref().to_string() };
        (problem, Some(value.span().start))
    })
}

fn within(
    key: &'static str,
    value: &Spanned<f64>,
    expected: &str,
    range: core::ops::RangeInclusive<f64>,
) -> Result<f64, Wrong> {
    let found = *value.get_ref();
    if range.contains(&found) {
        return Ok(found);
    }
    let problem = Problem::Value { key, expected: expected.into(), found: found.to_string() };
    Err((problem, Some(value.span().start)))
}

/// When it happens.
fn when(kind: &'static str, form: &Form) -> Result<When, Wrong> {
    let tick = |key, value: &Spanned<i64>| {
        u64::try_from(*value.get_ref()).map_err(|_| {
            let problem =
                Problem::Value { key, expected: "a tick".into(), found: value.get_ref().to_string() };
            (problem, Some(value.span().start))
        })
    };
    let at = form.at.as_ref().map(|at| tick("at", at)).transpose()?;
    let from = form.from.as_ref().map(|from| tick("from", from)).transpose()?;
    let until = form.until.as_ref().map(|until| tick("until", until)).transpose()?;
    let after = form.after.as_ref().map(|after| within("after", after, "seconds", 0.0..=1e6)).transpose()?;
    let after = after.map(|seconds| libm::round(seconds / TICK_S) as u64);
    let rate = form
        .rate
        .as_ref()
        .map(|rate| within("rate", rate, "a chance of 0.000001 to 1", 1e-6..=1.0))
        .transpose()?;
    let ticks = match &form.ticks {
        Some(ticks) if !(1..=MOST_TICKS).contains(ticks.get_ref()) => {
            let expected = format!("1 to {MOST_TICKS}");
            let problem = Problem::Value { key: "ticks", expected, found: ticks.get_ref().to_string() };
            return Err((problem, Some(ticks.span().start)));
        }
        Some(ticks) => Some(tick("ticks", ticks)?),
        None => None,
    };
    if kind == "intermittent" && rate.is_none() {
        return Err((Problem::Needs { kind, needs: "`rate`: the chance of failing in a tick" }, None));
    }
    if [at, from, after].iter().flatten().count() > 1 {
        return Err((Problem::Beginnings, None));
    }
    let length = ticks.unwrap_or(1);
    if let Some(at) = at {
        if until.is_some() {
            return Err((Problem::AtAndUntil, None));
        }
        let until = at.saturating_add(if rate.is_some() { 1 } else { length });
        return Ok(When { from: at, until, rate, ticks: length });
    }
    if ticks.is_some() && rate.is_none() {
        return Err((Problem::TwoLengths, None));
    }
    let (from, until) = (from.or(after).unwrap_or(0), until.unwrap_or(u64::MAX));
    if from >= until {
        return Err((Problem::EmptyWindow { from, until }, None));
    }
    Ok(When { from, until, rate, ticks: length })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell() -> CellDescription {
        CellDescription::from_toml(include_str!("../../../../data/cell.toml")).unwrap()
    }

    fn faults(text: &str) -> Vec<(String, When)> {
        let read = parse("f.toml", text, &cell()).unwrap();
        read.cell.faults.into_iter().map(|fault| (fault.what.to_string(), fault.when)).collect()
    }

    #[test]
    fn every_kind_is_read() {
        let text = "seed = 7\n\
            [[fault]]\nkind = \"off\"\nsensor = \"beam.3\"\nfrom = 200\nuntil = 500\n\
            [[fault]]\nkind = \"stuck\"\nsensor = \"grip.potentiometer\"\nvalue = 900\nat = 10\nticks = 5\n\
            [[fault]]\nkind = \"stuck\"\nsensor = \"resolver.shoulder\"\nafter = 8.0\n\
            [[fault]]\nkind = \"noisy\"\nsensor = \"force.z\"\nby = 40\nrate = 0.01\nticks = 25\n\
            [[fault]]\nkind = \"slow\"\nsensor = \"grip.strain-left\"\nby = 3\n\
            [[fault]]\nkind = \"intermittent\"\nsensor = \"quick-change.id\"\nrate = 0.5\n\
            [[fault]]\nkind = \"offset\"\nsensor = \"table.potentiometer\"\nby = -12\n\
            [[fault]]\nkind = \"drift\"\nsensor = \"force.x\"\nby = 2.5\n\
            [[fault]]\nkind = \"stuck\"\nvalve = \"grip.close-fine\"\nvalue = \"open\"\n\
            [[fault]]\nkind = \"stuck\"\nvalve = \"quick-change.port\"\nvalue = \"closed\"\n\
            [[fault]]\nkind = \"stuck\"\ndevice = \"lock-ring\"\n\
            [[fault]]\nkind = \"stuck\"\ndevice = \"vise-jaw\"\n\
            [[fault]]\nkind = \"air-lost\"\nat = 7\n\
            [[fault]]\nkind = \"hydraulics-lost\"\nfrom = 9\n\
            [[fault]]\nkind = \"camera-blind\"\n\
            [[fault]]\nkind = \"missing\"\n\
            [[fault]]\nkind = \"misplaced\"\nobject = \"LINKBAR1_BH\"\nx = 1.5\n\
            [[fault]]\nkind = \"turned\"\nangle = 30\nrate = 0.5\n\
            [[fault]]\nkind = \"wrong-part\"\nobject = \"LINKBAR1_BH\"\npart = \"LCLEVIS_BH\"\n\
            [[fault]]\nkind = \"pedestal-moved\"\nx = 0.5\ny = -0.25\nangle = 2\n\
            [[fault]]\nkind = \"flip\"\nrate = 0.001\n";
        let read = faults(text);
        let window = |from, until| When { from, until, ..When::ALWAYS };
        let expected = [
            ("beam.3 is off", window(200, 500)),
            ("grip.potentiometer is stuck at 900", When { ticks: 5, ..window(10, 15) }),
            ("resolver.shoulder is stuck", window(200, u64::MAX)),
            ("force.z is noisy by 40 counts", When { rate: Some(0.01), ticks: 25, ..When::ALWAYS }),
            ("grip.strain-left is 0.12 s late", When::ALWAYS),
            ("quick-change.id is off", When { rate: Some(0.5), ..When::ALWAYS }),
            ("table.potentiometer is off by -12 counts", When::ALWAYS),
            ("force.x drifts by +2.5 counts a second", When::ALWAYS),
            ("valve grip.close-fine is stuck open", When::ALWAYS),
            ("valve quick-change.port is stuck closed", When::ALWAYS),
            ("the locking ring is stuck", When::ALWAYS),
            ("the jaw of the vise is stuck", When::ALWAYS),
            ("the air is lost", window(7, 8)),
            ("the hydraulics are lost", window(9, u64::MAX)),
            ("the camera is blind", When::ALWAYS),
            ("what is delivered does not come", When::ALWAYS),
            ("LINKBAR1_BH lies 1.5 in, 0 in beside its place", When::ALWAYS),
            ("what is delivered is turned by 30 degrees", When { rate: Some(0.5), ..When::ALWAYS }),
            ("LCLEVIS_BH comes instead of LINKBAR1_BH", When::ALWAYS),
            ("the pedestal stands 0.5 in, -0.25 in, 2 degrees beside its mark", When::ALWAYS),
        ];
        for (read, (text, when)) in read.iter().zip(expected) {
            assert_eq!(*read, (text.to_owned(), when));
        }
        assert_eq!(read.len(), expected.len());
        let read = parse("f.toml", text, &cell()).unwrap();
        assert_eq!((read.cell.seed, read.line.map(|plan| plan.rules().len())), (7, Some(1)));
    }

    #[test]
    fn errors_say_where_what_was_expected_and_what_was_found() {
        for (entry, expected) in [
            (
                "kind = \"stuk\"",
                "line 5, fault 2: there is no kind of fault \"stuk\"; did you mean \"stuck\"?",
            ),
            (
                "kind = \"off\"\nsensor = \"grip.potentimeter\"",
                "line 6, fault 2: there is no sensor \"grip.potentimeter\"; did you mean \"grip.potentiometer\"?",
            ),
            (
                "kind = \"stuck\"\nvalve = \"grip.shut\"\nvalue = \"open\"",
                "line 6, fault 2: there is no valve",
            ),
            (
                "kind = \"stuck\"\nvalve = \"grip.vent\"\nvalue = \"ajar\"",
                "line 7, fault 2: `value`: expected \"open\" or \"closed\", found \"ajar\"",
            ),
            ("kind = \"stuck\"\nvalve = \"grip.vent\"", "line 4, fault 2: stuck needs `value`"),
            ("kind = \"stuck\"\ndevice = \"door\"", "line 6, fault 2: there is no device \"door\""),
            ("kind = \"stuck\"", "line 4, fault 2: stuck needs one of `sensor`, `valve` and `device`"),
            (
                "kind = \"stuck\"\nsensor = \"beam.1\"\nvalue = 2",
                "line 7, fault 2: `value`: expected 0 to 1, found 2",
            ),
            (
                "kind = \"off\"\nsensor = \"beam.1\"\nvalues = 2",
                "line 7, fault 2: off takes no `values`; it takes kind, sensor, at, from, after, until, rate, ticks",
            ),
            ("kind = \"noisy\"\nsensor = \"beam.1\"", "line 4, fault 2: noisy needs `by`: how much"),
            (
                "kind = \"slow\"\nsensor = \"beam.1\"\nby = 0",
                "line 7, fault 2: `by`: expected 1 to 1000 ticks, found 0",
            ),
            ("kind = \"noisy\"\nsensor = \"beam.1\"\nby = nan", "line 7, fault 2: `by`: expected counts"),
            ("kind = \"slow\"\nsensor = \"camera\"\nby = 3", "line 6, fault 2: the camera is no converter"),
            (
                "kind = \"intermittent\"\nsensor = \"beam.1\"",
                "line 4, fault 2: intermittent needs `rate`: the chance of failing in a tick",
            ),
            (
                "kind = \"air-lost\"\nrate = 1.5",
                "line 6, fault 2: `rate`: expected a chance of 0.000001 to 1, found 1.5",
            ),
            ("kind = \"air-lost\"\nat = -1", "line 6, fault 2: `at`: expected a tick, found -1"),
            (
                "kind = \"air-lost\"\nat = 1\nafter = 2.0",
                "line 4, fault 2: expected one of `at`, `from` and `after`",
            ),
            ("kind = \"air-lost\"\nat = 1\nuntil = 2", "line 4, fault 2: `at` is one moment"),
            (
                "kind = \"air-lost\"\nfrom = 9\nuntil = 9",
                "line 4, fault 2: expected `until` behind the beginning",
            ),
            ("kind = \"air-lost\"\nfrom = 9\nticks = 9", "line 4, fault 2: a range of ticks without a rate"),
            ("kind = \"air-lost\"\nat = \"soon\"", "line 6, fault 2: invalid type: string \"soon\""),
            (
                "kind = \"air-lost\"\nrate = 0.1\nticks = 0",
                "line 7, fault 2: `ticks`: expected 1 to 100000, found 0",
            ),
            ("kind = \"turned\"", "line 4, fault 2: turned needs `angle`"),
            ("kind = \"missing\"\nobject = \"BAR\"", "line 6, fault 2: there is no part \"BAR\" in the cell"),
            ("kind = \"wrong-part\"", "line 4, fault 2: wrong-part needs `part`: what comes instead"),
            ("kind = \"pedestal-moved\"\nat = 3", "line 6, fault 2: pedestal-moved takes no `at`"),
            ("kind = \"misplaced\"\nx = 101", "line 6, fault 2: `x`: expected -100 to 100 in, found 101"),
            ("kind = \"flip\"\nrate = 2", "line 6, fault 2: expected a rate of 0.000001 to 1, found 2"),
        ] {
            let text = format!("[[fault]]\nkind = \"flip\"\nrate = 0.1\n[[fault]]\n{entry}\n");
            let said = parse("f.toml", &text, &cell()).unwrap_err().to_string();
            assert!(
                said.starts_with(&format!("f.toml, {expected}")),
                "{entry}\n  says     {said}\n  expected {expected}"
            );
        }
    }

    #[test]
    fn a_missing_file_is_named() {
        let said = load(Path::new("no/such/file.toml"), &cell()).unwrap_err().to_string();
        assert!(said.starts_with("no/such/file.toml: cannot be read: "), "{said}");
    }
}
