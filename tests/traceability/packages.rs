//! Every package has a row in ARCHITECTURE.md and uses only the packages that the row permits.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
};

use toml::Table;
use whole_system_tests::root;

fn rows() -> BTreeMap<String, BTreeSet<String>> {
    let page = fs::read_to_string(root().join("ARCHITECTURE.md")).expect("the page is there");
    let lines = page.lines().skip_while(|line| !line.starts_with("| package |"));
    let rows = lines.take_while(|line| line.starts_with('|')).skip(2);
    rows.map(|row| {
        let cells: Vec<&str> = row.split(" | ").collect();
        let [package, _, permitted] = cells[..] else { panic!("three cells were expected in {row}") };
        let names = permitted.split('`').skip(1).step_by(2).filter(|name| *name != "load");
        (package.trim_matches(['|', ' ', '`']).to_owned(), names.map(str::to_owned).collect())
    })
    .collect()
}

fn permitted(rows: &BTreeMap<String, BTreeSet<String>>, package: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut open = vec![package.to_owned()];
    while let Some(next) = open.pop() {
        open.extend(rows.get(&next).into_iter().flatten().cloned());
        found.insert(next);
    }
    found
}

fn manifest(directory: &str) -> Table {
    let path = root().join(directory).join("Cargo.toml");
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    text.parse().unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn used() -> BTreeMap<String, BTreeSet<String>> {
    let workspace = manifest(".");
    let members = workspace["workspace"]["members"].as_array().expect("a list of members");
    let manifests: Vec<Table> =
        members.iter().map(|member| manifest(member.as_str().expect("a directory"))).collect();
    let name = |manifest: &Table| manifest["package"]["name"].as_str().expect("a name").to_owned();
    let names: BTreeSet<String> = manifests.iter().map(name).collect();
    let of = |manifest: &Table| {
        let dependencies = manifest.get("dependencies").and_then(|table| table.as_table());
        let used = dependencies.into_iter().flat_map(|table| table.keys());
        used.filter(|used| names.contains(*used)).cloned().collect()
    };
    manifests.iter().map(|manifest| (name(manifest), of(manifest))).collect()
}

#[test]
fn every_package_uses_only_what_its_row_permits() {
    let (rows, used) = (rows(), used());
    assert_eq!(rows.keys().collect::<Vec<_>>(), used.keys().collect::<Vec<_>>(), "rows and packages differ");
    let mut wrong = Vec::new();
    for (package, used) in &used {
        let permitted = permitted(&rows, package);
        wrong.extend(
            used.iter()
                .filter(|used| !permitted.contains(*used))
                .map(|used| format!("{package} uses {used}")),
        );
        let unused = rows[package].difference(used);
        // The package of the tests uses the libraries of a run only in its unit tests.
        let unused = unused.filter(|_| package != "whole-system-tests");
        wrong.extend(unused.map(|unused| format!("{package} may use {unused} and does not")));
    }
    assert!(wrong.is_empty(), "ARCHITECTURE.md and Cargo.toml differ:\n{}", wrong.join("\n"));
}
