//! Faults as TOML files with one table per fault, of the cell or of the line to the robot controller.
//!
//! ```toml
//! seed = 7                        # for all faults of the file, combined with the seed of the run; default 1
//!
//! [[fault]]
//! kind = "stuck"                  # off stuck noisy slow intermittent offset drift: a sensor
//! sensor = "grip.potentiometer"
//! value = 900                     # stuck: at this count; default: at the present one
//! from = 200                      # first tick, or after = 8.0 seconds ...
//! until = 500                     # ... and the first tick after the fault; or at = 200, and ticks = 300
//!
//! [[fault]]
//! kind = "noisy"                  # by: counts (noisy, offset), counts a second (drift), ticks of delay (slow)
//! sensor = "force.z"
//! by = 40
//! rate = 0.01                     # probability of beginning in each tick; it then lasts `ticks` ticks, default 1
//! ticks = 25
//!
//! [[fault]]
//! kind = "stuck"                  # a valve
//! valve = "grip.close-medium"
//! value = "closed"                # or "open"
//!
//! [[fault]]
//! kind = "wrong-part"             # missing misplaced turned wrong-part: a delivery to a tray
//! object = "LINKBAR1_BH"          # of this part; default: of any part
//! part = "LCLEVIS_BH"
//!
//! [[fault]]
//! kind = "flip"                   # drop flip duplicate delay insert truncate stall cts-low: the line ([`depc::fault`])
//! direction = "to-host"           # to-host, to-controller; default: both
//! rate = 0.001                    # probability for each byte (drop flip duplicate delay) or each tick (others)
//! ```
//! A fault of the line can also have `byte = 0x06` (insert); the file can have `most_per_tick`, the greatest number of
//! line faults per tick and direction. Other faults of the cell: `stuck` with `device = "lock-ring"` or `"vise-jaw"`,
//! `air-lost`, `hydraulics-lost`, `camera-blind`, `pedestal-moved`, and `field-cut` with a `device` of field I/O. A
//! fault without a time is always present; a fault of the line needs a rate, a tick or a range of ticks.
//!
//! Parsing reports all errors of a file at once.

mod cell;
mod line;

use std::fmt;

use depc::fault::Plan;
use diagnostics::{
    Diagnostics, Problem, Source,
    toml::{Document, FileKind, element, join},
};
use serde::{Deserialize, Deserializer, de};

use super::FaultPlan;
use crate::description::CellDescription;

const KIND: FileKind = FileKind {
    whole: "the file",
    syntax: "fault.syntax",
    key: "fault.key",
    missing: "fault.missing",
    value: "fault.value",
    magnitudes: [1e-6, 1e5],
};

#[derive(Clone, Debug, Default, PartialEq)]
pub struct FaultFile {
    pub line: Option<Plan>,
    pub cell: FaultPlan,
}

/// Parses a fault file for a cell.
pub fn parse(source: &Source, cell: &CellDescription) -> Result<FaultFile, Diagnostics> {
    sheet(source, Some(cell))
}

/// Parses a file with faults of the line only. Errors: all errors in the file, including faults of the cell.
pub fn parse_line(source: &Source) -> Result<Plan, Diagnostics> {
    let read = sheet(source, None)?;
    Ok(read.line.unwrap_or_else(|| Plan::new(read.cell.seed)))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Sheet {
    #[serde(default = "first_seed")]
    seed: u64,
    most_per_tick: Option<u8>,
    #[serde(default)]
    fault: Vec<Form>,
}

const fn first_seed() -> u64 {
    1
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Form {
    kind: String,
    direction: Option<String>,
    sensor: Option<String>,
    valve: Option<String>,
    device: Option<String>,
    value: Option<Value>,
    by: Option<f64>,
    byte: Option<u8>,
    object: Option<String>,
    part: Option<String>,
    x: Option<f64>,
    y: Option<f64>,
    angle: Option<f64>,
    at: Option<u64>,
    from: Option<u64>,
    after: Option<f64>,
    until: Option<u64>,
    rate: Option<f64>,
    ticks: Option<u32>,
}

impl Form {
    fn keys(&self) -> impl Iterator<Item = &'static str> {
        let there = [
            ("direction", self.direction.is_some()),
            ("sensor", self.sensor.is_some()),
            ("valve", self.valve.is_some()),
            ("device", self.device.is_some()),
            ("value", self.value.is_some()),
            ("by", self.by.is_some()),
            ("byte", self.byte.is_some()),
            ("object", self.object.is_some()),
            ("part", self.part.is_some()),
            ("x", self.x.is_some()),
            ("y", self.y.is_some()),
            ("angle", self.angle.is_some()),
            ("at", self.at.is_some()),
            ("from", self.from.is_some()),
            ("after", self.after.is_some()),
            ("until", self.until.is_some()),
            ("rate", self.rate.is_some()),
            ("ticks", self.ticks.is_some()),
        ];
        there.into_iter().filter(|(_, is_there)| *is_there).map(|(key, _)| key)
    }
}

#[derive(Clone, Debug)]
enum Value {
    Count(i64),
    Word(String),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count(count) => write!(f, "{count}"),
            Self::Word(word) => write!(f, "{word:?}"),
        }
    }
}

impl<'de> Deserialize<'de> for Value {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl de::Visitor<'_> for Either {
            type Value = Value;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number, or a text in quotes")
            }

            fn visit_i64<E: de::Error>(self, count: i64) -> Result<Value, E> {
                Ok(Value::Count(count))
            }

            fn visit_str<E: de::Error>(self, word: &str) -> Result<Value, E> {
                Ok(Value::Word(word.to_owned()))
            }
        }
        deserializer.deserialize_any(Either)
    }
}

struct Entry<'f> {
    form: &'f Form,
    path: String,  // its path: `fault[0]`
    number: usize, // its number in the file, from 1
}

impl Entry<'_> {
    fn unlike(&self, key: &str, expected: impl fmt::Display, found: impl fmt::Display) -> Box<Problem> {
        Box::new(Problem::unlike(KIND.value, &join(&self.path, key), expected, found))
    }

    fn unknown(&self, key: &str, found: &str, known: &[&str]) -> Box<Problem> {
        let expected = format!("one of {}", known.join(", "));
        let problem = Problem::unlike("fault.name", &join(&self.path, key), expected, format!("{found:?}"));
        Box::new(problem.near(found, known))
    }

    /// The problem of keys that contradict each other.
    fn says(&self, message: impl fmt::Display) -> Box<Problem> {
        let (path, kind) = (&self.path, &self.form.kind);
        Box::new(Problem::of_entry(KIND.value, path, format!("{path}: {kind} {message}")))
    }

    /// A number within a range; `expected` describes the range in the message.
    fn within(
        &self,
        key: &str,
        found: f64,
        expected: &str,
        range: core::ops::RangeInclusive<f64>,
    ) -> Result<f64, Box<Problem>> {
        if range.contains(&found) { Ok(found) } else { Err(self.unlike(key, expected, found)) }
    }

    /// Problems of the keys that a kind does not have.
    fn untaken(&self, takes: &[&str]) -> impl Iterator<Item = Problem> {
        self.form.keys().filter(|key| !takes.contains(key)).map(|key| {
            let message =
                format!("{}: {} takes no {key}; it takes {}", self.path, self.form.kind, takes.join(", "));
            Problem::of_entry(KIND.key, &join(&self.path, key), message)
        })
    }
}

/// Reads a file and collects all its errors. Without a cell, faults of the cell are errors.
fn sheet(source: &Source, cell: Option<&CellDescription>) -> Result<FaultFile, Diagnostics> {
    let mut file = FaultFile::default();
    Document::load(source, KIND, |sheet: &Sheet, stand_ins, problems| {
        if sheet.fault.is_empty() && stand_ins.trusts("fault") {
            let message = "expected at least one [[fault]], found none";
            problems.add(Problem::of_entry(KIND.missing, "", message.into()));
        }
        if sheet.most_per_tick == Some(0) {
            problems.add(Problem::unlike(KIND.value, "most_per_tick", "1 to 255 faults", 0));
        }
        file.cell.seed = sheet.seed;
        for (index, form) in sheet.fault.iter().enumerate() {
            let entry = Entry { form, path: element("fault", index), number: index + 1 };
            if stand_ins.trusts(&entry.path) {
                problems.extend(take(&entry, cell, sheet, &mut file));
            }
        }
    })?;
    Ok(file)
}

fn take(
    entry: &Entry<'_>,
    cell: Option<&CellDescription>,
    sheet: &Sheet,
    file: &mut FaultFile,
) -> Vec<Problem> {
    let mut problems = Vec::new();
    if let Some(kind) = line::kind(&entry.form.kind) {
        problems.extend(entry.untaken(&line::KEYS));
        let plan = file.line.get_or_insert_with(|| line::empty(sheet.seed, sheet.most_per_tick));
        match line::rule(entry, kind) {
            Ok(rule) if problems.is_empty() => {
                let refused = |refusal| *entry.says(format_args!("is refused: {refusal}"));
                problems.extend(plan.add(rule).err().map(refused));
            }
            Ok(_) => {}
            Err(problem) => problems.push(*problem),
        }
        return problems;
    }
    let (Some(cell), Some(kind)) = (cell, cell::kind(&entry.form.kind)) else {
        let kinds = line::kinds().chain(cell.iter().flat_map(|_| cell::kinds()));
        let unknown = entry.unknown("kind", &entry.form.kind, &kinds.collect::<Vec<_>>());
        let elsewhere = cell.is_none() && cell::kind(&entry.form.kind).is_some();
        let problem = if elsewhere {
            entry.says("is a fault of the cell: such faults are for rcs-run")
        } else {
            unknown
        };
        return vec![*problem];
    };
    problems.extend(entry.untaken(&kind.takes()));
    match cell::fault(entry, kind, cell) {
        Ok(fault) => file.cell.faults.push(fault),
        Err(problem) if problems.is_empty() => problems.push(*problem),
        Err(_) => {}
    }
    problems
}

#[cfg(test)]
mod tests;
