//! Converts the keys of a mapping file to a mapping, and reports every mistake.

mod devices;
mod groups;
mod lines;
mod points;
mod spans;

use diagnostics::{
    Problem, Problems,
    toml::{Defaulted, join},
};

use self::{devices::Devices, spans::Taken};
use super::{FORM, KIND, Mapping, form::Sheet};

fn unlike(path: &str, expected: impl std::fmt::Display, found: impl std::fmt::Display) -> Problem {
    Problem::unlike(KIND.value, path, expected, found)
}

fn says(path: &str, message: impl std::fmt::Display) -> Problem {
    Problem::of_entry(KIND.value, path, format!("{path}: {message}"))
}

/// The mapping of a file, and its errors. The problems of entries with stand-ins are already reported.
pub(super) fn build(sheet: &Sheet, stand_ins: &Defaulted, problems: &mut Problems) -> Mapping {
    if sheet.form != FORM && stand_ins.trusts("form") {
        problems.add(unlike("form", format_args!("{FORM}, which this version reads"), sheet.form));
    }
    let mut devices = Devices::of(sheet, stand_ins, problems);
    let mut taken = Taken::default();
    let mut inputs = Vec::new();
    for (name, form) in &sheet.inputs {
        let path = join("in", name);
        match points::input(&path, name, form, &devices, &mut taken) {
            _ if !stand_ins.trusts(&path) => {}
            Ok(point) => inputs.push(point),
            Err(problem) => problems.add(*problem),
        }
    }
    let mut outputs = Vec::new();
    let mut taken_out = Taken::default();
    for (name, form) in &sheet.outputs {
        let path = join("out", name);
        match points::output(&path, name, form, &devices, &mut taken_out) {
            _ if !stand_ins.trusts(&path) => {}
            Ok(point) => outputs.push(point),
            Err(problem) => problems.add(*problem),
        }
    }
    devices.lay_out(&taken, &mut inputs, &taken_out, &mut outputs, problems);
    let presence = groups::presence(sheet, stand_ins, problems);
    let holds = groups::holds(sheet, stand_ins, problems);
    let lines = lines::lines(sheet, stand_ins, &inputs, &outputs, problems);
    Mapping { name: sheet.name.clone(), devices: devices.list, inputs, outputs, presence, lines, holds }
}
