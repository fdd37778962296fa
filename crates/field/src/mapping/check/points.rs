//! The points: their name, their place, and how their value is stored.

use std::ops::RangeInclusive;

use couplers::Fallback;
use diagnostics::{Problem, toml::join};
use interfaces::point::{Input, Kind as InputKind, Output, Point};

use super::{
    super::{
        InPoint, Origin, OutPoint, Slot, Target,
        form::{InForm, OutForm},
        place::Place,
    },
    devices::Devices,
    says,
    spans::Taken,
    unlike,
};
use crate::scale::{Format, Line};

/// Permitted ages after which a point is stale, ms; the least is one tick.
const STALE_MS: RangeInclusive<u16> = 40..=10_000;
const SHARED: &str = "grip.potentiometer"; // the input that the three grippers share (III.3.7)

pub(super) fn input(
    path: &str,
    name: &str,
    form: &InForm,
    devices: &Devices,
    taken: &mut Taken,
) -> Result<InPoint, Box<Problem>> {
    let at = |key: &str| join(path, key);
    let point = Point::read(name).ok_or_else(|| {
        let known: Vec<&str> = Input::all().map(Input::name).collect();
        let elsewhere = if Point::written(name).is_some() {
            "it is an output: write it into [out]"
        } else {
            "it is not an input"
        };
        Box::new(says(path, format_args!("{elsewhere}; the names are in docs/field.md")).near(name, &known))
    })?;
    let target = match point {
        Point::Input(input) if matches!(input.kind(), InputKind::Cable | InputKind::Camera) => {
            let message = format!("{name} is a name for faults of several sensors: map each of them");
            return Err(Box::new(says(path, message)));
        }
        Point::Input(input) => Target::Word(input),
        Point::Output(_) | Point::Station(_) => Target::Station,
    };
    let range = point.range();
    if !STALE_MS.contains(&form.stale_ms) {
        return Err(Box::new(unlike(&at("stale_ms"), "40 to 10000 ms", form.stale_ms)));
    }
    for (key, value) in [("then", form.then), ("fixed", form.fixed)] {
        if let Some(found) = value.filter(|value| !range.contains(value)) {
            return Err(Box::new(unlike(
                &at(key),
                format_args!("{} to {}", range.start(), range.end()),
                found,
            )));
        }
    }
    let from = match (&form.at, form.fixed) {
        (Some(place), None) => {
            let shape = Shape {
                is_bit: point.is_bit(),
                format: form.format,
                words: form.words.as_deref(),
                invert: form.invert,
            };
            let slot = slot(path, name, place, &shape, devices, taken, Direction::In)?;
            if form.raw.is_none() {
                fits(path, slot.format, &range)?;
            }
            Origin::Slot(slot)
        }
        (None, Some(value)) => Origin::Fixed(value),
        _ => return Err(Box::new(says(path, "needs one of `at` and `fixed`"))),
    };
    let line = match (form.raw, form.counts) {
        (None, None) => None,
        (Some(raw), Some(counts)) => Some(line_of(path, raw, counts, &range)?),
        _ => return Err(Box::new(says(path, "needs both `raw` and `counts`, or neither"))),
    };
    if line.is_some() && (point.is_bit() || matches!(from, Origin::Fixed(_))) {
        return Err(Box::new(says(path, "takes no `raw` and `counts`: its value is not measured")));
    }
    let mut by_gripper = [None; 3];
    for (gripper, form) in &form.by_gripper {
        let path = join(&at("by_gripper"), gripper);
        if name != SHARED {
            return Err(Box::new(says(&path, format_args!("only {SHARED} depends on the gripper"))));
        }
        let index = ["1", "2", "3"].iter().position(|known| known == gripper);
        let entry = index.and_then(|index| by_gripper.get_mut(index));
        let entry = entry.ok_or_else(|| Box::new(unlike(&path, "the id of a gripper, 1 to 3", gripper)))?;
        *entry = Some(line_of(&path, form.raw, form.counts, &range)?);
    }
    let (group, then, stale_ms) = (point.group(), form.then, form.stale_ms);
    Ok(InPoint { name: name.to_owned(), target, stale_ms, group, from, range, line, by_gripper, then })
}

pub(super) fn output(
    path: &str,
    name: &str,
    form: &OutForm,
    devices: &Devices,
    taken: &mut Taken,
) -> Result<OutPoint, Box<Problem>> {
    let at = |key: &str| join(path, key);
    let point = Point::written(name).ok_or_else(|| {
        let known: Vec<&str> = Output::all().map(Output::name).collect();
        let elsewhere = if Point::read(name).is_some() {
            "it is an input: write it into [in]"
        } else {
            "it is not an output"
        };
        Box::new(says(path, format_args!("{elsewhere}; the names are in docs/field.md")).near(name, &known))
    })?;
    let target = match point {
        Point::Output(output) => Target::Word(output),
        Point::Input(_) | Point::Station(_) => Target::Station,
    };
    let range = point.range();
    if !range.contains(&form.safe) {
        return Err(Box::new(unlike(
            &at("safe"),
            format_args!("{} to {}", range.start(), range.end()),
            form.safe,
        )));
    }
    let shape = Shape {
        is_bit: point.is_bit(),
        format: form.format,
        words: form.words.as_deref(),
        invert: form.invert,
    };
    let slot = slot(path, name, &form.at, &shape, devices, taken, Direction::Out)?;
    fits(path, slot.format, &range)?;
    let plan = devices.list.get(slot.device).map(|device| &device.plan);
    let after = plan.map(|plan| (plan.fallback, plan.kind));
    match after {
        // The coupler then has the word 0, to which `invert` applies.
        Some((Fallback::Zero, _)) if form.safe != i64::from(form.invert && point.is_bit()) => {
            let expected = format!(
                "{}, which the device gives when its watchdog fires (fallback = \"zero\")",
                i64::from(form.invert && point.is_bit())
            );
            return Err(Box::new(unlike(&at("safe"), expected, form.safe)));
        }
        Some((Fallback::Hold, kind)) if !form.rest => {
            let why = match kind.facts().watchdog {
                None => "has no watchdog",
                Some(_) => "keeps its outputs when its watchdog fires (fallback = \"hold\")",
            };
            let message = format!(
                "its device {why}, so it stays on when the controller is lost; only an output with `rest = true` \
                 may be there"
            );
            return Err(Box::new(says(path, message)));
        }
        _ => {}
    }
    Ok(OutPoint {
        name: name.to_owned(),
        target,
        safe: form.safe,
        rest: form.rest,
        group: point.group(),
        slot,
        range,
    })
}

struct Shape<'f> {
    is_bit: bool,
    format: Option<Format>,
    words: Option<&'f str>,
    invert: bool,
}

#[derive(Clone, Copy, PartialEq)]
enum Direction {
    In,
    Out,
}

/// Where a point is. Its word in the image is found once all points are known.
fn slot(
    path: &str,
    name: &str,
    text: &str,
    shape: &Shape<'_>,
    devices: &Devices,
    taken: &mut Taken,
    direction: Direction,
) -> Result<Slot, Box<Problem>> {
    let at = join(path, "at");
    let found = || format!("{text:?}");
    let place = Place::parse(text).map_err(|expected| Box::new(unlike(&at, expected, found())))?;
    let device = devices.named(&at, place.device)?;
    if direction == Direction::Out && !place.area.is_writable() {
        return Err(Box::new(unlike(&at, "a coil or a holding register, which can be written", found())));
    }
    let is_bit = place.area.has_bits() || place.bit.is_some();
    let format = shape.format.unwrap_or(if is_bit { Format::Bit } else { Format::U16 });
    if shape.is_bit && !is_bit {
        let expected = "a bit, such as \"DEVICE input 8.0\", for a point with the values 0 and 1";
        return Err(Box::new(unlike(&at, expected, found())));
    }
    if !shape.is_bit && is_bit {
        return Err(Box::new(unlike(&at, "a whole register for a point that is a number", found())));
    }
    if (format == Format::Bit) != is_bit {
        let expected = if is_bit { "no type but \"bit\" for a bit" } else { "one of u16, i16, u32, i32" };
        return Err(Box::new(unlike(&join(path, "type"), expected, format.text())));
    }
    if shape.invert && !is_bit {
        return Err(Box::new(says(
            &join(path, "invert"),
            "only a bit can be inverted; use `raw` and `counts`",
        )));
    }
    let low_first = match shape.words {
        None => false,
        Some(_) if format.registers() == 1 => {
            return Err(Box::new(says(
                &join(path, "words"),
                "only a value of two registers has an order of words",
            )));
        }
        Some("low-first") => true,
        Some("high-first") => false,
        Some(other) => {
            let expected = "\"high-first\" or \"low-first\"";
            return Err(Box::new(unlike(&join(path, "words"), expected, format_args!("{other:?}"))));
        }
    };
    // A device with a mistake of its own has no registers yet.
    let Some(device) = device else {
        return Ok(Slot { device: 0, word: 0, bit: None, format, low_first, invert: false });
    };
    if let Some(plan) = devices.list.get(device).map(|device| &device.plan) {
        let facts = plan.kind.facts();
        let (what, legal) = match (direction, place.area.has_bits()) {
            (Direction::Out, true) => ("a coil", &facts.coils),
            (Direction::Out, false) => ("a register", &facts.outputs),
            (Direction::In, true) => ("a discrete input", &(0..=u16::MAX)),
            (Direction::In, false) => ("a register", &facts.inputs),
        };
        let last = place.address.checked_add(format.registers() - 1);
        let inside = last.is_some_and(|last| legal.contains(&place.address) && legal.contains(&last));
        if !inside {
            let expected = format!(
                "{what} from {:#X} to {:#X} of kind {}",
                legal.start(),
                legal.end(),
                plan.kind.text()
            );
            return Err(Box::new(unlike(&at, expected, found())));
        }
    }
    let what = (place.area, place.address, place.bit);
    taken.take(name, device, what, format.registers()).map_err(|other| {
        Box::new(unlike(&at, format_args!("an address that no other point has, as {other} does"), found()))
    })?;
    Ok(Slot { device, word: 0, bit: place.bit, format, low_first, invert: shape.invert })
}

/// Checks that the format can store all values of a point that has no line.
fn fits(path: &str, format: Format, range: &RangeInclusive<i64>) -> Result<(), Box<Problem>> {
    let stored = format.range();
    if stored.contains(range.start()) && stored.contains(range.end()) {
        return Ok(());
    }
    let wanted = if *range.start() < 0 { "i32" } else { "u32" };
    let (least, most) = (range.start(), range.end());
    let expected = format!("a type for the values {least} to {most}, such as {wanted:?}");
    Err(Box::new(unlike(&join(path, "type"), expected, format.text())))
}

/// A line, if it has a slope and its counts are in range.
fn line_of(
    path: &str,
    raw: [f64; 2],
    counts: [f64; 2],
    range: &RangeInclusive<i64>,
) -> Result<Line, Box<Problem>> {
    if raw[0] >= raw[1] {
        let found = format!("[{}, {}]", raw[0], raw[1]);
        return Err(Box::new(unlike(&join(path, "raw"), "two raw values, the lower one first", found)));
    }
    let (least, most) = (*range.start() as f64, *range.end() as f64);
    let inside = counts.iter().all(|counts| (least..=most).contains(counts));
    if !inside || counts[0] == counts[1] {
        let found = format!("[{}, {}]", counts[0], counts[1]);
        let expected = format!("two different values from {least} to {most}");
        return Err(Box::new(unlike(&join(path, "counts"), expected, found)));
    }
    Ok(Line { raw, counts })
}
