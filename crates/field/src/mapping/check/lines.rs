//! The `[[line]]` entries: how the devices execute lines of jobs.

use std::collections::BTreeMap;

use diagnostics::{
    Problem, Problems,
    toml::{Defaulted, element, join},
};

use super::{
    super::{
        InPoint, OutPoint,
        form::{SequenceForm, Sheet},
    },
    says, unlike,
};
use crate::lines::{Condition, Sequence, Setting, normalized};

/// First words of the lines that devices can execute.
const VERBS: [&str; 4] = ["vise", "machine", "drum", "tray"];

pub(super) fn lines(
    sheet: &Sheet,
    stand_ins: &Defaulted,
    inputs: &[InPoint],
    outputs: &[OutPoint],
    problems: &mut Problems,
) -> Vec<Sequence> {
    // A mistake in a point would cause further mistakes in its lines.
    if !problems.is_empty() {
        return Vec::new();
    }
    let points = Points { inputs, outputs };
    let mut lines: Vec<Sequence> = Vec::new();
    for (index, form) in sheet.line.iter().enumerate() {
        let path = element("line", index);
        if !stand_ins.trusts(&path) {
            continue;
        }
        match points.sequence(&path, form) {
            Ok(sequence) if lines.iter().any(|other| other.line == sequence.line) => {
                let expected = "a line that no other entry has";
                problems.add(unlike(&join(&path, "line"), expected, format_args!("{:?}", form.line)));
            }
            Ok(sequence) => lines.push(sequence),
            Err(problem) => problems.add(*problem),
        }
    }
    lines
}

struct Points<'a> {
    inputs: &'a [InPoint],
    outputs: &'a [OutPoint],
}

impl Points<'_> {
    fn sequence(&self, path: &str, form: &SequenceForm) -> Result<Sequence, Box<Problem>> {
        let at = |key: &str| join(path, key);
        let line = normalized(&form.line);
        let verb = line.split(' ').next().unwrap_or_default();
        if !VERBS.contains(&verb) {
            let expected = format!("a line of a job that begins with {}", VERBS.join(", "));
            return Err(Box::new(unlike(&at("line"), expected, format_args!("{:?}", form.line))));
        }
        if form.done.is_empty() {
            return Err(Box::new(unlike(&at("done"), "at least one input that shows the end", "none")));
        }
        if form.sets.is_empty() && form.ask.is_none() {
            return Err(Box::new(says(path, "needs one of `sets` and `ask`")));
        }
        for (key, seconds) in [("within_s", form.within_s), ("begun_within_s", form.begun_within_s)] {
            if seconds == 0 {
                return Err(Box::new(unlike(&at(key), "1 to 65535 s", seconds)));
            }
        }
        let conditions = |key: &str, texts: &[String]| -> Result<Vec<Condition>, Box<Problem>> {
            let each = texts.iter().enumerate();
            each.map(|(index, text)| self.condition(&element(&at(key), index), text)).collect()
        };
        Ok(Sequence {
            needs: conditions("needs", &form.needs)?,
            begun: conditions("begun", &form.begun)?,
            done: conditions("done", &form.done)?,
            during: conditions("while", &form.during)?,
            fault: conditions("fault", &form.fault)?,
            sets: self.settings(&at("sets"), &form.sets)?,
            then: self.settings(&at("then"), &form.then)?,
            ask: form.ask.clone().unwrap_or_default(),
            begun_within_s: form.begun_within_s,
            within_s: form.within_s,
            line,
        })
    }

    /// `NAME`, `!NAME` or `NAME = VALUE`.
    fn condition(&self, path: &str, text: &str) -> Result<Condition, Box<Problem>> {
        let (name, value, is_bit) = match (text.strip_prefix('!'), text.split_once('=')) {
            (Some(name), _) => (name.trim(), Some(0), true),
            (None, Some((name, value))) => (name.trim(), value.trim().parse().ok(), false),
            (None, None) => (text.trim(), Some(1), true),
        };
        let found = || format!("{text:?}");
        let known: Vec<&str> = self.inputs.iter().filter(|point| point.is_station()).map(name_of).collect();
        let input = self.inputs.iter().position(|point| point.is_station() && point.name == name);
        let Some(input) = input else {
            let expected = "an input of [in] of vise, machine, drum, trays or supply";
            return Err(Box::new(unlike(path, expected, found()).near(name, &known)));
        };
        let range = self.inputs.get(input).map_or(0..=1, |point| point.range.clone());
        let value = value.filter(|value| range.contains(value) && (!is_bit || *range.end() == 1));
        let expected = match range.end() {
            1 => format!("{name} or !{name}"),
            most => format!("{name} = VALUE with a value of 0 to {most}"),
        };
        let value = value.ok_or_else(|| Box::new(unlike(path, expected, found())))?;
        Ok(Condition { input, value })
    }

    fn settings(&self, path: &str, forms: &BTreeMap<String, i64>) -> Result<Vec<Setting>, Box<Problem>> {
        let each = forms.iter().map(|(name, value)| {
            let path = join(path, name);
            let output = self.outputs.iter().position(|point| point.is_station() && point.name == *name);
            let Some(output) = output else {
                let known: Vec<&str> = self
                    .outputs
                    .iter()
                    .filter(|point| point.is_station())
                    .map(|point| point.name.as_str())
                    .collect();
                let expected = "an output of [out] to vise, machine or drum";
                return Err(Box::new(unlike(&path, expected, format_args!("{name:?}")).near(name, &known)));
            };
            let range = self.outputs.get(output).map_or(0..=1, |point| point.range.clone());
            if !range.contains(value) {
                let expected = format!("{} to {}", range.start(), range.end());
                return Err(Box::new(unlike(&path, expected, value)));
            }
            Ok(Setting { output, value: *value })
        });
        each.collect()
    }
}

fn name_of(point: &InPoint) -> &str {
    &point.name
}
