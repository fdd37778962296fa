//! No link is broken, every page is in the table of contents, and no source is too long.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use whole_system_tests::root;

mod columns;
mod paths;
mod type_names;
mod words;

const PLACES: [&str; 9] = [".", "docs", "docs/design", "data", "crates", "bins", "benches", "fuzz", "tests"];

fn pages() -> BTreeSet<PathBuf> {
    let entries = |directory: &Path| {
        let entries = fs::read_dir(directory).expect("the directory is there");
        entries.map(|entry| entry.expect("it can be listed").path()).collect::<Vec<_>>()
    };
    let mut pages = BTreeSet::new();
    for place in PLACES {
        let listed = entries(&root().join(place));
        let below = listed.iter().filter(|path| path.is_dir() && place != ".").flat_map(|path| entries(path));
        pages.extend(below.chain(listed.clone()).filter(|path| path.extension().is_some_and(|e| e == "md")));
    }
    pages
}

fn prose(text: &str) -> String {
    let mut inside = false;
    let outside = |line: &&str| {
        let fence = line.trim_start().starts_with("```");
        inside ^= fence;
        !fence && !inside
    };
    text.lines().filter(outside).collect::<Vec<_>>().join("\n")
}

fn links(text: &str) -> Vec<&str> {
    text.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target).collect()
}

fn anchors(text: &str) -> BTreeSet<String> {
    let headings = text.lines().filter(|line| line.starts_with('#'));
    let anchor = |heading: &str| {
        let kept = heading.trim_start_matches('#').trim().to_lowercase();
        kept.chars()
            .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'))
            .map(|c| if c == ' ' { '-' } else { c })
            .collect()
    };
    headings.map(anchor).collect()
}

#[test]
fn no_link_is_broken() {
    let mut broken = Vec::new();
    let pages = pages();
    assert!(pages.len() > 40, "{} pages were found", pages.len());
    for page in &pages {
        let text = prose(&fs::read_to_string(page).expect("the page can be read"));
        for link in
            links(&text).into_iter().filter(|link| !link.contains("://") && !link.starts_with("mailto:"))
        {
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = if file.is_empty() { page.clone() } else { page.with_file_name(file) };
            let is_there = target.exists()
                && (anchor.is_empty()
                    || fs::read_to_string(&target).is_ok_and(|text| anchors(&prose(&text)).contains(anchor)));
            if !is_there {
                broken.push(format!("{}: {link}", page.display()));
            }
        }
    }
    assert!(broken.is_empty(), "links that lead nowhere:\n{}", broken.join("\n"));
}

#[test]
fn every_page_is_in_the_contents_once() {
    let docs = root().join("docs");
    let summary = fs::read_to_string(docs.join("SUMMARY.md")).expect("the contents are there");
    let mut listed: Vec<_> = links(&summary).into_iter().map(|link| docs.join(link)).collect();
    listed.sort();
    let is_page = |path: &&PathBuf| path.starts_with(&docs) && !path.ends_with("SUMMARY.md");
    let pages: Vec<_> = pages().iter().filter(is_page).cloned().collect();
    assert_eq!(listed, pages);
}

const WIDEST: usize = 110;
const WRITTEN: [&str; 2] = ["traceability.md", "cli.md"];

/// A table, an indented block, a link, a picture, the name of a test.
fn may_be_wide(line: &str) -> bool {
    line.starts_with(['|', '#'])
        || line.starts_with("    ")
        || line.contains("](")
        || line.trim_start().starts_with("- test:")
}

#[test]
fn prose_is_within_110_columns() {
    let mut wide = Vec::new();
    for page in pages().iter().filter(|page| !WRITTEN.iter().any(|written| page.ends_with(written))) {
        let text = fs::read_to_string(page).expect("the page can be read");
        let lines = prose(&text);
        let lines = lines.lines().filter(|line| line.chars().count() > WIDEST && !may_be_wide(line));
        wide.extend(lines.map(|line| format!("{}: {line}", page.display())));
    }
    assert!(wide.is_empty(), "lines of more than {WIDEST} columns:\n{}", wide.join("\n"));
}

const LONGEST: usize = 400; // lines, without comments, blank lines and tests

fn sources() -> Vec<PathBuf> {
    let (mut open, mut sources) = (vec![root().join("crates"), root().join("bins")], Vec::new());
    while let Some(directory) = open.pop() {
        let entries = fs::read_dir(&directory).expect("the directory is there");
        for path in entries.map(|entry| entry.expect("it can be listed").path()) {
            let is_of_tests = path.file_stem().is_some_and(|name| name == "tests" || name == "benches");
            if path.is_dir() && !is_of_tests {
                open.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") && !is_of_tests {
                sources.push(path);
            }
        }
    }
    sources
}

/// An item under `#[cfg(test)]` ends with a `;` or a brace at its own indentation.
fn lines_of_code(text: &str) -> usize {
    let mut lines = text.lines();
    let mut count = 0;
    while let Some(line) = lines.next() {
        if line.trim() == "#[cfg(test)]" {
            let item = lines.by_ref().find(|line| !line.trim().starts_with('#')).unwrap_or_default();
            let indentation = &item[..item.len() - item.trim_start().len()];
            if !item.ends_with(';') {
                let end = format!("{indentation}}}");
                lines.by_ref().find(|line| line.trim_end_matches([',', ';']) == end);
            }
        } else if !line.trim().is_empty() && !line.trim_start().starts_with("//") {
            count += 1;
        }
    }
    count
}

#[test]
fn no_source_is_long() {
    assert_eq!(
        lines_of_code(
            "a\n// b\n\n#[cfg(test)]\n#[path = \"c\"]\nmod c;\nd {\n}\n#[cfg(test)]\nmod e {\n  f\n}\ng\n"
        ),
        4
    );
    let sources = sources();
    let count = sources.len();
    let lengths = sources.into_iter().map(|path| {
        let lines = lines_of_code(&fs::read_to_string(&path).expect("the source can be read"));
        (path, lines)
    });
    let long: Vec<_> = lengths
        .filter(|(_, lines)| *lines > LONGEST)
        .map(|(path, lines)| format!("{}: {lines} lines", path.display()))
        .collect();
    assert!(count > 300, "{count} sources were found");
    assert!(long.is_empty(), "split these by meaning, {LONGEST} lines at most:\n{}", long.join("\n"));
}

#[test]
fn every_crate_page_names_an_example() {
    let crates = fs::read_dir(root().join("crates")).expect("the directory is there");
    let mut count = 0;
    for path in crates.map(|entry| entry.expect("it can be listed").path()) {
        let page = fs::read_to_string(path.join("README.md")).expect("a crate has a page");
        count += 1;
        // The crate that re-exports its macros shows them.
        if path.ends_with("rcs-macros") {
            continue;
        }
        let examples = fs::read_dir(path.join("examples")).expect("a crate has examples");
        let names = examples.map(|entry| entry.expect("it can be listed").path());
        let mut names = names.filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()));
        assert!(names.any(|name| page.contains(&name)), "{}: no example is named", path.display());
    }
    assert!(count >= 18, "{count} crates were found");
}
