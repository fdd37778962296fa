//! Text without control characters: an escape sequence in a log or job could control the reader's terminal.

use std::{borrow::Cow, fmt::Display};

/// Marks that change the direction of text, and separators of lines and paragraphs.
const INVISIBLE: [char; 15] = [
    '\u{61c}', '\u{200e}', '\u{200f}', '\u{2028}', '\u{2029}', '\u{202a}', '\u{202b}', '\u{202c}',
    '\u{202d}', '\u{202e}', '\u{2066}', '\u{2067}', '\u{2068}', '\u{2069}', '\u{feff}',
];

/// A control character other than tab and newline, or a mark that changes the direction of text.
fn is_unsafe(character: char) -> bool {
    is_control_or_mark(character) && !matches!(character, '\n' | '\t')
}

/// A control character, or a mark that changes the direction of text.
pub(crate) fn is_control_or_mark(character: char) -> bool {
    character.is_control() || INVISIBLE.contains(&character)
}

/// Replaces control characters by `?` or another visible one, except tab and newline. Byte positions do not change.
#[must_use]
pub fn plain(text: &str) -> Cow<'_, str> {
    if !text.contains(is_unsafe) {
        return Cow::Borrowed(text);
    }
    let visible = |character: char| match character.len_utf8() {
        _ if !is_unsafe(character) => character,
        1 => '?',
        2 => '\u{b7}',
        _ => char::REPLACEMENT_CHARACTER,
    };
    Cow::Owned(text.chars().map(visible).collect())
}

/// Escapes the control characters that JSON permits in strings, such as `\u009b`. The value does not change.
#[must_use]
pub fn escaped_json(json: &str) -> Cow<'_, str> {
    if !json.contains(is_unsafe) {
        return Cow::Borrowed(json);
    }
    let escape = |character: char| match is_unsafe(character) {
        true => format!("\\u{:04x}", u32::from(character)),
        false => character.to_string(),
    };
    Cow::Owned(json.chars().map(escape).collect())
}

/// A count with its noun: `1 error`, `2 errors`, `0 retries`.
#[must_use]
pub fn amount<N: Display + PartialEq + From<u8>>(count: N, one: &str) -> String {
    if count == N::from(1) {
        return format!("{count} {one}");
    }
    match one.strip_suffix('y') {
        Some(stem) if !stem.ends_with(['a', 'e', 'o', 'u']) => format!("{count} {stem}ies"),
        _ if one.ends_with(['s', 'h']) => format!("{count} {one}es"),
        _ => format!("{count} {one}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_become_visible_and_keep_byte_positions() {
        let text = "one\u{1b}[31mtwo\x07\u{9b}2J\u{202e}x\ttab\nline\r\u{7f}";
        let shown = plain(text);
        assert_eq!(shown, "one?[31mtwo?\u{b7}2J\u{fffd}x\ttab\nline??");
        assert_eq!(shown.len(), text.len());
        assert!(matches!(plain("ordinary text, ä µ …\n"), Cow::Borrowed(_)));
    }

    #[test]
    fn amount_has_the_plural_unless_it_is_one() {
        assert_eq!([0_u64, 1, 2].map(|count| amount(count, "tick")), ["0 ticks", "1 tick", "2 ticks"]);
        let twice = |one| amount(2_usize, one);
        assert_eq!(["retry", "tray", "branch"].map(twice), ["2 retries", "2 trays", "2 branches"]);
    }

    #[test]
    fn json_strings_keep_their_value() {
        assert_eq!(escaped_json("{\"a\":\"\u{9b}2J\u{7f}\"}\n"), "{\"a\":\"\\u009b2J\\u007f\"}\n");
    }
}
