//! Sources and their tests.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use whole_system_tests::root;

const CRATES: [&str; 2] = ["crates", "bins"]; // their names with `_` are those of `cargo test`

pub struct Sources(BTreeMap<PathBuf, String>); // every Rust file, by its path from the root of the repository

impl Sources {
    pub fn read() -> Self {
        let mut all = BTreeMap::new();
        for directory in CRATES.into_iter().chain(["tests", "gateway"]) {
            gather(&root().join(directory), &mut all);
        }
        Self(all)
    }

    pub fn files(&self) -> impl Iterator<Item = (&Path, &str)> {
        self.0.iter().map(|(path, text)| (path.as_path(), text.as_str()))
    }

    pub fn text(&self, path: &str) -> Option<&str> {
        self.0.get(Path::new(path)).map(String::as_str)
    }

    /// The name is as `cargo test` prints it after its crate: `levels::task::tests::name`.
    pub fn has_unit_test(&self, name: &str) -> bool {
        let Some((modules, test)) = name.rsplit_once("::") else { return false };
        self.module(modules).is_some_and(|(text, inline)| {
            inline.iter().all(|module| has_item(text, "mod", module)) && has_test(text, test)
        })
    }

    /// The file of a module, and the modules that must be inside the file.
    fn module<'a>(&self, name: &'a str) -> Option<(&str, Vec<&'a str>)> {
        let parts: Vec<&str> = name.split("::").collect();
        let (first, modules) = parts.split_first()?;
        let directory = CRATES.map(|directory| format!("{directory}/{}/src", first.replace('_', "-")));
        let source = directory.iter().find(|source| self.0.keys().any(|path| path.starts_with(source)))?;
        (0..=modules.len()).rev().find_map(|length| {
            let (files, inline) = modules.split_at(length);
            let stem = [&[source.as_str()], files].concat().join("/");
            let candidates = match files {
                [] => [format!("{stem}/lib.rs"), format!("{stem}/main.rs")],
                _ => [format!("{stem}.rs"), format!("{stem}/mod.rs")],
            };
            Some((candidates.iter().find_map(|path| self.text(path))?, inline.to_vec()))
        })
    }
}

fn gather(directory: &Path, all: &mut BTreeMap<PathBuf, String>) {
    for entry in fs::read_dir(directory).expect("a directory").map(|entry| entry.expect("an entry").path()) {
        if entry.is_dir() {
            if entry.file_name().is_some_and(|name| name != "target") {
                gather(&entry, all);
            }
        } else if entry.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&entry).expect("a source");
            let path = entry.strip_prefix(root()).expect("a file of the repository").to_owned();
            all.insert(path, text);
        }
    }
}

pub fn has_test(source: &str, name: &str) -> bool {
    source.match_indices(&format!("fn {name}(")).any(|(at, _)| {
        let before = &source[..at]; // the attribute, or the macro of a property test, is shortly before it
        before.lines().rev().take(6).any(|line| matches!(line.trim(), "#[test]" | "proptest! {"))
            || before.rfind("proptest! {") > before.rfind("\n}\n")
    })
}

pub fn has_item(source: &str, kind: &str, name: &str) -> bool {
    let start = format!("{kind} {name}");
    source.match_indices(&start).any(|(at, _)| {
        let after = source[at + start.len()..].chars().next();
        after.is_none_or(|letter| !letter.is_alphanumeric() && letter != '_')
    })
}
