//! Types of different control processes have different names, so that a name in a message or search identifies the
//! process.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::PathBuf,
};

use whole_system_tests::{root, tables::files};

/// `commands!` and `Process` need these names; the module identifies the process.
const IN_EACH_PROCESS: [&str; 7] =
    ["Action", "Request", "Situation", "State", "StateVariables", "Step", "Subordinates"];

fn types(text: &str) -> impl Iterator<Item = &str> {
    let (text, _) = text.split_once("#[cfg(test)]\nmod tests {").unwrap_or((text, ""));
    text.lines().filter_map(|line| {
        let item = line.strip_prefix("pub ").or_else(|| line.strip_prefix("pub(crate) "))?;
        let (kind, rest) = item.split_once(' ')?;
        let is_type = ["struct", "enum", "trait", "type"].contains(&kind);
        let end = rest.find(|c: char| !c.is_alphanumeric()).unwrap_or(rest.len());
        is_type.then(|| &rest[..end])
    })
}

#[test]
fn types_of_control_processes_have_different_names() {
    let levels = root().join("crates/levels/src");
    let mut paths: Vec<PathBuf> = Vec::new();
    files(&levels, "rs", &mut paths).expect("the directory can be listed");
    let is_test = |path: &PathBuf| {
        path.ends_with("tests.rs") || path.components().any(|part| part.as_os_str() == "tests")
    };
    let mut places: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for path in paths.iter().filter(|path| !is_test(path)) {
        let text = fs::read_to_string(path).expect("the file can be read");
        let place = path.strip_prefix(&levels).unwrap_or(path).display().to_string();
        for name in types(&text).filter(|name| !IN_EACH_PROCESS.contains(name)) {
            places.entry(name.to_owned()).or_default().insert(place.clone());
        }
    }
    assert!(places.len() > 200, "{} types were found", places.len());
    let repeated: Vec<_> = places.iter().filter(|(_, places)| places.len() > 1).collect();
    assert!(repeated.is_empty(), "prefix these names with that of their process: {repeated:#?}");
}
