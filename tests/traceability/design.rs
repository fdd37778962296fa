//! Files and tests in the rules of docs/design, and in the promises of other pages, exist. A rule is followed by `-
//! code:` and `- test:`, also over indented lines. A text in backquotes is a reference:
//!
//! | under   | reference                  | must be there                                                   |
//! |---------|----------------------------|-----------------------------------------------------------------|
//! | `code`  | `crates/levels/src/lib.rs` | the file or directory                                           |
//! | `code`  | `republish`, in brackets   | the word in the file that was named before it                   |
//! | `test`  | `levels::task::tests::name`| the test in the file of the module                              |
//! | `test`  | `tests/jobs.rs: name`      | the test in the file                                            |
//! | `test`  | `name`                     | a test or a module of that name somewhere                       |

use std::fs;

use whole_system_tests::root;

use super::sources::{Sources, has_item, has_test};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Code,
    Test,
}

#[derive(Debug, PartialEq, Eq)]
struct Item {
    line: usize, // first line
    kind: Kind,
    text: String,
}

fn items(page: &str) -> Vec<Item> {
    let mut items: Vec<Item> = Vec::new();
    let mut is_open = false;
    for (line, text) in (1..).zip(page.lines()) {
        let begun = text
            .strip_prefix("- code: ")
            .map(|text| (Kind::Code, text))
            .or_else(|| text.strip_prefix("- test: ").map(|text| (Kind::Test, text)));
        match (begun, items.last_mut()) {
            (Some((kind, text)), _) => {
                items.push(Item { line, kind, text: text.to_owned() });
                is_open = true;
            }
            (None, Some(last)) if is_open && text.starts_with("  ") => {
                last.text += " ";
                last.text += text.trim_start();
            }
            _ => is_open = false,
        }
    }
    items
}

/// Texts in backquotes, and true if a bracket is open before them.
fn references(text: &str) -> Vec<(&str, bool)> {
    let parts = text.split('`').collect::<Vec<_>>();
    let words = parts.iter().step_by(2);
    let open = words.scan(0_usize, |depth, words| {
        *depth = *depth + words.matches('(').count() - words.matches(')').count().min(*depth);
        Some(*depth > 0)
    });
    parts.iter().skip(1).step_by(2).copied().zip(open).collect()
}

fn missing(item: &Item, sources: &Sources) -> Vec<String> {
    match item.kind {
        Kind::Code => missing_code(&item.text),
        Kind::Test => missing_tests(&item.text, sources),
    }
}

fn missing_code(text: &str) -> Vec<String> {
    let (mut missing, mut file): (_, Option<(&str, String)>) = (Vec::new(), None);
    for (reference, in_brackets) in references(text) {
        if reference.contains('/') || reference.ends_with(".toml") {
            let path = root().join(reference);
            if !path.exists() {
                missing.push(format!("no file {reference}"));
            }
            // A reference to a directory needs no more checks.
            file = fs::read_to_string(path).ok().map(|text| (reference, text));
        } else if let Some((path, text)) = file.as_ref().filter(|_| in_brackets) {
            // Both names of `TaskVerb::of` are searched.
            let is_name = |word: &&str| !word.is_empty() && !word.starts_with(|c: char| c.is_ascii_digit());
            let mut names = reference.split(|c: char| !c.is_alphanumeric() && c != '_').filter(is_name);
            if let Some(name) = names.find(|name| !has_word(text, name)) {
                missing.push(format!("no {name} in {path}"));
            }
        }
    }
    missing
}

fn has_word(text: &str, word: &str) -> bool {
    text.split(|c: char| !c.is_alphanumeric() && c != '_').any(|found| found == word)
}

fn missing_tests(text: &str, sources: &Sources) -> Vec<String> {
    let is_there = |reference: &str| match reference.split_once(": ") {
        Some((path, name)) => sources.text(path).is_some_and(|text| has_test(text, name)),
        None if reference.contains("::") => sources.has_unit_test(reference),
        None if reference.contains('/') => root().join(reference).exists(),
        None => {
            sources.files().any(|(_, text)| has_test(text, reference) || has_item(text, "mod", reference))
        }
    };
    let all: Vec<&str> = references(text).into_iter().map(|(reference, _)| reference).collect();
    if all.is_empty() && !text.contains("no test") {
        return vec!["neither a test nor `no test`".to_owned()];
    }
    all.into_iter()
        .filter(|reference| !is_there(reference))
        .map(|reference| format!("no test {reference}"))
        .collect()
}

#[test]
fn files_and_tests_named_by_rules_exist() {
    let sources = Sources::read();
    let (mut wrong, mut count) = (Vec::new(), 0);
    let directories = ["docs", "docs/design"].map(|directory| fs::read_dir(root().join(directory)));
    for entry in directories.into_iter().flat_map(|entries| entries.expect("the pages are there")) {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "md") {
            continue;
        }
        let page = fs::read_to_string(&path).expect("a page");
        let name = path.strip_prefix(root()).expect("a file of the repository").display();
        for item in items(&page) {
            count += 1;
            wrong.extend(missing(&item, &sources).iter().map(|what| format!("{name}:{}: {what}", item.line)));
        }
    }
    wrong.sort();
    assert!(wrong.is_empty(), "the code moved on, and the pages did not:\n{}", wrong.join("\n"));
    assert!(count > 100, "only {count} lines were found: has their form changed?");
}

#[test]
fn broken_reference_is_detected() {
    let sources = Sources::read();
    let page = "\
Text with `no/reference.rs` in it.
- code: `tests/traceability/sources.rs` (`has_test`, `Sources::nothing`), `tests/nowhere.rs`,
  called by `somebody`
- test: `levels::execution::tests::outcome_stays_until_a_new_number`
- test: `levels::execution::tests::no_such_test` (what is not: no test)
- test: `tests/traceability/design.rs:
  broken_reference_is_detected`, and `no_test_of_this_name`

  `tests/behind_the_list.rs`
- test: nobody has thought of one
- test: no test (types)
";
    let found: Vec<_> = items(page)
        .iter()
        .flat_map(|item| missing(item, &sources).into_iter().map(|what| (item.line, what)))
        .collect();
    let expected = [
        (2, "no nothing in tests/traceability/sources.rs"),
        (2, "no file tests/nowhere.rs"),
        (5, "no test levels::execution::tests::no_such_test"),
        (6, "no test no_test_of_this_name"),
        (10, "neither a test nor `no test`"),
    ];
    assert_eq!(found, expected.map(|(line, what)| (line, what.to_owned())));
}
