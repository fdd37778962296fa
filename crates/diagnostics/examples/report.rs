//! Reports three errors of a TOML file: underlined in the text, on one line, and as JSON for an editor.

use std::io::Write as _;

use diagnostics::{
    Finding, Problem, Source,
    toml::{Document, FileKind},
};
use serde::Deserialize;

const KIND: FileKind = FileKind {
    whole: "the file",
    syntax: "motor.syntax",
    key: "motor.key",
    missing: "motor.missing",
    value: "motor.value",
    magnitudes: [1e-6, 1e5],
};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Motor {
    name: String,
    speed: f64,
    current: f64,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let text = "name = \"M1\"\nsped = 1500\ncurrent = -2\nvoltage = 400\n";
    let source = Source { name: "motor.toml".to_owned(), text: text.into() };
    let mut out = std::io::stdout();
    let read = Document::load(&source, KIND, |motor: &Motor, stand_ins, problems| {
        if motor.current < 0.0 && stand_ins.trusts("current") {
            problems.add(Problem::unlike(KIND.value, "current", "0 or more", motor.current));
        }
    });
    match read {
        Ok(Motor { name, speed, .. }) => writeln!(out, "{name} turns at {speed}")?,
        Err(report) => {
            let findings: Vec<Finding> = report.diagnostics().iter().map(Finding::from).collect();
            writeln!(out, "{report}\n{}\n", report.in_line())?;
            writeln!(out, "{}", serde_json::to_string_pretty(&findings)?)?;
        }
    }
    Ok(())
}
