use std::fs;

use whole_system_tests::root;

use super::{pages, prose};

/// Only these directories are tracked, because runs and builds make others.
const TRACKED: [&str; 12] = [
    "benches", "bins", "crates", "data", "docs", "examples", "fuzz", "gateway", "python", "tests", "tools",
    "viewers",
];

/// A file or directory of the repository, in back quotes. A part in capitals is a placeholder.
fn is_path(text: &str) -> bool {
    let is_of_path = |c: char| c.is_ascii_alphanumeric() || matches!(c, '/' | '.' | '-' | '_');
    let mut parts = text.split('/');
    let is_below_root = parts.next().is_some_and(|first| TRACKED.contains(&first));
    let is_placeholder =
        |part: &str| part.starts_with(|c: char| c.is_ascii_uppercase()) && !part.ends_with(".md");
    is_below_root && text.contains('/') && text.chars().all(is_of_path) && !parts.any(is_placeholder)
}

#[test]
fn paths_in_pages_exist() {
    assert!(is_path("docs/words.toml") && is_path("crates/no-such-crate/src"));
    assert!(!is_path("data/robots/NAME.toml") && !is_path("runs/my.mcap") && !is_path("docs/*.png"));
    let (mut missing, mut count) = (Vec::new(), 0);
    for page in pages() {
        // Older versions had other files.
        if page.ends_with("CHANGELOG.md") {
            continue;
        }
        let text = prose(&fs::read_to_string(&page).expect("the page can be read"));
        for path in text.split('`').skip(1).step_by(2).filter(|quoted| is_path(quoted)) {
            count += 1;
            if !root().join(path).exists() && !page.with_file_name(path).exists() {
                missing.push(format!("{}: {path}", page.display()));
            }
        }
    }
    assert!(count > 100, "{count} paths were found");
    assert!(missing.is_empty(), "paths that do not exist:\n{}", missing.join("\n"));
}
