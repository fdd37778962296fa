//! Wrong variants of the shipped data (variants.toml): what `rcs-run check` says of each stands in docs/check-variants.md, and each
//! is refused before anything moves, or harmless for a reason.
//!
//! `RCS_VARIANTS=write cargo test -p rcs-run --test variants` writes the page anew.

use std::{
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use serde::Deserialize;
use serde_json::Value;

#[derive(Deserialize)]
struct Table {
    variant: Vec<Variant>,
}

/// One small edit of one file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Variant {
    group: String,
    name: String,
    file: String,
    /// The first of these becomes `to`.
    from: Option<String>,
    to: Option<String>,
    /// A change of the whole file.
    edit: Option<Edit>,
    /// Why it need not be refused.
    harmless: Option<String>,
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
    /// The file with the edit; `None` if it is gone.
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

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap().flatten() {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target)
        } else {
            drop(fs::copy(entry.path(), target))
        }
    }
}

/// What `check` says of a data directory.
fn findings(data: &Path) -> Vec<Value> {
    let output = Command::new(env!("CARGO_BIN_EXE_rcs-run"))
        .args(["check", "--json", "--data"])
        .arg(data)
        .stdin(Stdio::null())
        .output()
        .expect("the program starts");
    let found: Value = serde_json::from_slice(&output.stdout).expect("one JSON object");
    let refused = found["errors"] != 0;
    assert_eq!(output.status.code(), Some(if refused { 2 } else { 0 }), "{found}");
    found["findings"].as_array().expect("findings").clone()
}

/// What is said of a variant, one line a finding.
fn said(variant: &Variant, data: &Path) -> String {
    let file = data.join(&variant.file);
    let text = fs::read_to_string(&file).unwrap();
    match variant.edited(&text) {
        Some(bytes) => fs::write(&file, bytes).unwrap(),
        None => fs::remove_file(&file).unwrap(),
    }
    if matches!(variant.edit, Some(Edit::Directory)) {
        fs::create_dir(&file).unwrap();
    }
    let found = findings(data);
    if file.is_dir() {
        fs::remove_dir(&file).unwrap();
    }
    fs::write(&file, text).unwrap();
    let refused = found.iter().any(|finding| finding["severity"] == "error");
    assert_ne!(refused, variant.harmless.is_some(), "{}: {}: {found:#?}", variant.group, variant.name);
    let mut said = String::new();
    for finding in found {
        let word = |key: &str| {
            finding[key].as_str().unwrap_or_default().replace(&data.display().to_string(), "data")
        };
        let place = if word("place").is_empty() { String::new() } else { word("place") + ": " };
        writeln!(said, "- {}: {place}{}", word("severity"), word("message")).unwrap();
        if !word("help").is_empty() {
            writeln!(said, "  help: {}", word("help")).unwrap();
        }
    }
    if let Some(reason) = &variant.harmless {
        writeln!(said, "- harmless: {reason}").unwrap();
    }
    said
}

#[test]
fn every_variant_is_refused_before_anything_moves_or_harmless() {
    let table: Table = toml::from_str(include_str!("variants.toml")).unwrap();
    assert!(table.variant.len() >= 150, "{} variants", table.variant.len());
    let scratch = tempfile::tempdir().unwrap();
    let data = scratch.path().join("data");
    copy(&root().join("data"), &data);
    assert_eq!(findings(&data), Vec::<Value>::new(), "the shipped data have no finding");
    let mut page = format!(
        "# What `rcs-run check` says of {} wrong variants\n\nWritten by `RCS_VARIANTS=write cargo test -p rcs-run --test variants` from \
         `bins/rcs-run/tests/variants.toml`, which\nhas each edit. A variant with an error is refused before anything moves.\n",
        table.variant.len()
    );
    let mut group = "";
    for variant in &table.variant {
        if variant.group != group {
            group = &variant.group;
            writeln!(page, "\n## {group}").unwrap();
        }
        write!(page, "\n**{}** ({})\n\n{}", variant.name, variant.file, said(variant, &data)).unwrap();
    }
    let path = root().join("docs/check-variants.md");
    if std::env::var_os("RCS_VARIANTS").is_some_and(|value| value == "write") {
        fs::write(&path, &page).unwrap();
    }
    let kept = fs::read_to_string(&path).unwrap_or_default();
    let differs = page.lines().zip(kept.lines()).find(|(one, other)| one != other);
    assert_eq!(page, kept, "docs/check-variants.md is not what check says: {differs:?}");
}
