//! Wrong variants of the shipped data (variants.toml), and the findings of `rcs-run check` for each (variants.txt),
//! which `RCS_VARIANTS=write cargo test --release -p programs --lib variants` writes. Each variant is refused before
//! the robot moves, or has a reason why it is harmless.

use std::{
    fmt::Write as _,
    fs, iter,
    path::{Path, PathBuf},
    sync::atomic::{AtomicUsize, Ordering},
    thread,
};

use serde::Deserialize;

use super::{Checked, Finding, Flights, data::copy};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

#[derive(Deserialize)]
struct Table {
    variant: Vec<Variant>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Variant {
    group: String,
    name: String,
    file: String,
    from: Option<String>, // the edit replaces the first occurrence of this text by `to`
    to: Option<String>,
    edit: Option<Edit>,       // a change of the whole file
    harmless: Option<String>, // the reason why `check` may accept the variant
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Edit {
    Bom,
    Cr,
    Crlf,
    Tabs,
    Latin1,
    Empty,
    Comments,
    Directory,
    Missing,
}

impl Variant {
    /// The text of the file after the edit; `None` if the edit removes the file.
    fn edited(&self, text: &str) -> Option<Vec<u8>> {
        let Some(edit) = self.edit else {
            let (from, to) = (self.from.as_deref().unwrap(), self.to.as_deref().unwrap());
            assert!(text.contains(from), "{}: {} has no {from:?}", self.name, self.file);
            return Some(text.replacen(from, to, 1).into_bytes());
        };
        Some(match edit {
            Edit::Bom => format!("\u{feff}{text}").into_bytes(),
            Edit::Cr => text.replace('\n', "\r").into_bytes(),
            Edit::Crlf => text.replace('\n', "\r\n").into_bytes(),
            Edit::Tabs => text.replace("    ", "\t").into_bytes(),
            Edit::Latin1 => [b"%% \xe4\n", text.as_bytes()].concat(),
            Edit::Empty => Vec::new(),
            Edit::Comments => b"% nothing\n".to_vec(),
            Edit::Directory | Edit::Missing => return None,
        })
    }
}

fn findings(data: &Path, flights: &Flights) -> Vec<Finding> {
    let outcome = Checked::of(data, flights).outcome();
    assert_eq!(outcome.ok, outcome.findings.iter().all(|finding| finding.severity != "error"));
    outcome.findings
}

/// The findings for a variant, one line per finding.
fn said(variant: &Variant, data: &Path, flights: &Flights) -> String {
    let file = data.join(&variant.file);
    let text = fs::read_to_string(&file).unwrap();
    match variant.edited(&text) {
        Some(bytes) => fs::write(&file, bytes).unwrap(),
        None => fs::remove_file(&file).unwrap(),
    }
    if matches!(variant.edit, Some(Edit::Directory)) {
        fs::create_dir(&file).unwrap();
    }
    let found = findings(data, flights);
    if file.is_dir() {
        fs::remove_dir(&file).unwrap();
    }
    fs::write(&file, text).unwrap();
    let refused = found.iter().any(|finding| finding.severity == "error");
    assert_ne!(
        refused,
        variant.harmless.is_some(),
        "{}: {}: {:#?}",
        variant.group,
        variant.name,
        messages(&found)
    );
    let mut said = String::new();
    for finding in &found {
        let word = |text: &str| text.replace(&data.display().to_string(), "data");
        let place = if finding.place.is_empty() { String::new() } else { word(&finding.place) + ": " };
        writeln!(said, "- {}: {place}{}", finding.severity, word(&finding.message)).unwrap();
        if let Some(help) = &finding.help {
            writeln!(said, "  help: {}", word(help)).unwrap();
        }
    }
    if let Some(reason) = &variant.harmless {
        writeln!(said, "- harmless: {reason}").unwrap();
    }
    said
}

fn messages(found: &[Finding]) -> Vec<&str> {
    found.iter().map(|finding| finding.message.as_str()).collect()
}

/// The findings for all variants, in order. Two threads check them, each in its own copy of the data directory.
fn all_said(variants: &[Variant]) -> Vec<String> {
    let (next, flights) = (AtomicUsize::new(0), Flights::default());
    let work = || {
        let scratch = tempfile::tempdir().unwrap();
        let data = scratch.path().join("data");
        copy(&root().join("data"), &data);
        assert_eq!(messages(&findings(&data, &flights)), [""; 0], "the shipped data have no finding");
        let numbers = iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed));
        let taken = numbers.map_while(|number| Some((number, variants.get(number)?)));
        taken.map(|(number, variant)| (number, said(variant, &data, &flights))).collect::<Vec<_>>()
    };
    let mut all = thread::scope(|scope| {
        let threads = [scope.spawn(work), scope.spawn(work)];
        threads.map(|thread| thread.join().unwrap()).concat()
    });
    all.sort_by_key(|(number, _)| *number);
    all.into_iter().map(|(_, said)| said).collect()
}

#[test]
fn every_variant_is_refused_or_harmless() {
    let table: Table = toml::from_str(include_str!("variants.toml")).unwrap();
    assert!(table.variant.len() >= 150, "{} variants", table.variant.len());
    let said = all_said(&table.variant);
    let mut text = format!(
        "Findings of `rcs-run check` for {} wrong variants of the shipped data. variants.toml has each edit.\n\
         Written by `RCS_VARIANTS=write cargo test --release -p programs --lib variants`.\n",
        table.variant.len()
    );
    let mut group = "";
    for (variant, said) in table.variant.iter().zip(said) {
        if variant.group != group {
            group = &variant.group;
            writeln!(text, "\n## {group}").unwrap();
        }
        write!(text, "\n**{}** ({})\n\n{}", variant.name, variant.file, said).unwrap();
    }
    let path = root().join("bins/rcs-run/src/check/variants.txt");
    if std::env::var_os("RCS_VARIANTS").is_some_and(|value| value == "write") {
        fs::write(&path, &text).unwrap();
    }
    let kept = fs::read_to_string(&path).unwrap_or_default();
    let differs = text.lines().zip(kept.lines()).find(|(one, other)| one != other);
    assert!(
        text == kept,
        "variants.txt differs from the findings of check; the first line found and kept: {differs:?}"
    );
}
