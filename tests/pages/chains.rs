//! docs/design/tables.md lists the chains of the sources. `RCS_PAGES=write cargo test --release --workspace --test
//! pages chains` writes it.

use std::{collections::BTreeMap, env, fs, path::PathBuf};

use whole_system_tests::{root, tables::files};

const PAGE: &str = "docs/design/tables.md";
const HEAD: &str = "| process | commands | tables in their order |\n|---|---|---|\n";

/// Names of tables by function: `e_pause` of `e_pause` is `E-PAUSE`.
fn names(sources: &[(PathBuf, String)]) -> BTreeMap<(PathBuf, String), String> {
    let mut names = BTreeMap::new();
    for (path, text) in sources {
        for line in text.lines().filter_map(|line| line.trim_start().strip_prefix("pub ")) {
            let Some((name, rest)) = line.split_once(": fn ") else { continue };
            let function: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            names.insert((path.with_extension(""), function), name.replace('_', "-"));
        }
    }
    names
}

fn chains(sources: &[(PathBuf, String)]) -> Vec<String> {
    let names = names(sources);
    let mut rows = Vec::new();
    for (path, text) in sources.iter().filter(|(path, _)| path.ends_with("tables/mod.rs")) {
        let directory = path.with_file_name("");
        let levels = root().join("crates/levels/src");
        let process = directory.parent().and_then(|process| process.strip_prefix(&levels).ok());
        let process = process.expect("tables are in the directory of a process").display();
        for line in text.lines().filter(|line| line.contains(" then ") && line.trim_end().ends_with(';')) {
            let (commands, entry) = line.split_once(": ").expect("an entry has commands");
            let (_, chain) = entry.split_once("=>").expect("an entry has tables");
            let name = |table: &str| {
                let (module, function) = table.trim().split_once("::").expect("a table has a module");
                names[&(directory.join(module), function.to_owned())].as_str()
            };
            let chain: Vec<_> = chain.trim_end_matches(';').split(" then ").map(name).collect();
            rows.push(format!(
                "| `{process}` | {} | {} |",
                commands.trim().replace(" | ", ", "),
                chain.join(", ")
            ));
        }
    }
    rows
}

#[test]
fn chains_of_the_page_are_those_of_the_sources() {
    let mut paths = Vec::new();
    files(&root().join("crates/levels/src"), "rs", &mut paths).expect("the directory can be listed");
    paths.sort();
    let read = |path: PathBuf| {
        let text = fs::read_to_string(&path).expect("the file can be read");
        (path, text)
    };
    let rows = chains(&paths.into_iter().map(read).collect::<Vec<_>>());
    assert!(rows.len() > 15, "{rows:?}");
    let page = root().join(PAGE);
    let text = fs::read_to_string(&page).expect("the page can be read");
    let (front, rest) = text.split_once(HEAD).expect("the page has the list");
    let (listed, rest) = rest.split_once("\n\n").expect("text follows the list");
    if env::var_os("RCS_PAGES").is_some_and(|value| value == "write") {
        fs::write(&page, format!("{front}{HEAD}{}\n\n{rest}", rows.join("\n")))
            .expect("the page can be written");
        return;
    }
    assert_eq!(listed.lines().collect::<Vec<_>>(), rows, "RCS_PAGES=write writes the list of {PAGE}");
}
