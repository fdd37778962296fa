//! A report with colours contains no control character from the file.

use diagnostics::{At, Diagnostics, Problems, Source};

/// Removes sequences for colour and emphasis.
fn without_colours(text: &str) -> String {
    let mut parts = text.split("\u{1b}[");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| {
        let end = part.find(|c: char| !c.is_ascii_digit() && c != ';').unwrap_or(part.len());
        text + part.get(end..).and_then(|rest| rest.strip_prefix('m')).unwrap_or("\u{1b} is not a colour")
    })
}

#[test]
fn a_drawn_report_has_no_control_characters_of_its_file() {
    let evil = "\u{1b}]0;title\u{7}\u{9b}2J\u{202e}";
    let text = format!("name = \"{evil}\"\n");
    let source = Source { name: format!("motor{evil}.toml"), text: text.into() };
    let mut problems = Problems::default();
    let at = At { source: 0, start: 8, length: 3 };
    problems.error_help("name", at, format!("a name was expected, found {evil}"), format!("write {evil}"));
    let drawn = Diagnostics::of_file(problems, &source).render(true);
    let plain = without_colours(&drawn);
    let found = plain.chars().find(|c| (c.is_control() && *c != '\n') || *c == '\u{202e}');
    assert_eq!(found, None, "{}", plain.escape_debug());
    assert!(plain.contains("?]0;title?\u{b7}2J\u{fffd}") && plain.contains("motor?"), "{plain}");
}
