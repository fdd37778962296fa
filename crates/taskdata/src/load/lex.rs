//! Words of a block, without comments.
//!
//! `%` at the beginning of a word makes the rest of the line a comment (IV.3.2). A word that begins with `(` begins a
//! comment up to the next `)`, possibly on a later line, without nesting (VIII.9; SPECNOTES.md, Task data). Only
//! blanks separate words, so `(` within a word, as in `A(B`, is part of a name.

use diagnostics::{At, Problems};

use super::source::{Block, SourceLine};

#[derive(Clone, Copy, Debug)]
pub struct Word<'a> {
    pub text: &'a str, // without blanks
    pub at: At,
    pub first: bool, // of its line
}

/// A tab separates words, too, but is reported as an error of the block.
const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t')
}

fn short(value: usize) -> u32 {
    u32::try_from(value).unwrap_or(u32::MAX)
}

fn piece(line: &SourceLine<'_>, from: usize, length: usize) -> At {
    At { start: line.at.start.saturating_add(short(from)), length: short(length), ..line.at }
}

#[must_use]
pub fn words_of_line<'a>(line: &SourceLine<'a>) -> Vec<Word<'a>> {
    let mut words = Vec::new();
    let mut open = None;
    scan(line, &mut open, &mut words);
    words
}

const WORDS_A_LINE: usize = 8; // reserved

/// An unclosed comment is an error.
pub fn words<'a>(block: &Block<'a>, problems: &mut Problems) -> Vec<Word<'a>> {
    let mut words = Vec::with_capacity(block.lines.len().saturating_mul(WORDS_A_LINE));
    let mut open = None;
    for line in &block.lines {
        scan(line, &mut open, &mut words);
    }
    if let Some(at) = open {
        problems.error_help(
            "comment.open",
            at,
            "this comment has no end in its block: `)` was expected",
            "comments in parentheses may span lines but not blocks",
        );
    }
    words
}

/// `open` is the beginning of an unclosed comment in parentheses.
fn scan<'a>(line: &SourceLine<'a>, open: &mut Option<At>, words: &mut Vec<Word<'a>>) {
    let bytes = line.text.as_bytes();
    let mut first = true;
    let mut position = 0;
    // Lines are short, so the bytes are tested one by one.
    let next = |from: usize, meant: fn(u8) -> bool| {
        bytes.get(from..).and_then(|rest| rest.iter().position(|b| meant(*b))).map(|ahead| from + ahead)
    };
    loop {
        if open.is_some() {
            let Some(end) = next(position, |b| b == b')') else { return };
            *open = None;
            position = end + 1;
            continue;
        }
        let Some(begin) = next(position, |b| !is_blank(b)) else { return };
        match bytes.get(begin) {
            Some(b'%') | None => return,
            Some(b'(') => {
                let length = line.text.trim_end().len().saturating_sub(begin);
                *open = Some(piece(line, begin, length));
                position = begin + 1;
            }
            Some(_) => {
                position = next(begin, is_blank).unwrap_or(bytes.len());
                // A blank is one byte, so a word begins and ends at a character boundary.
                let text = line.text.get(begin..position).unwrap_or_default();
                words.push(Word { text, at: piece(line, begin, text.len()), first });
                first = false;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::source::blocks;
    use diagnostics::Source;

    fn texts(block: &str) -> (Vec<String>, bool) {
        let source = Source { name: "t".into(), text: format!("BLOCK# 1 OFFSET 20000\n{block}").into() };
        let (blocks, _) = blocks(0, &source);
        let mut problems = Problems::default();
        let words = words(&blocks[0], &mut problems);
        for word in &words {
            let start = word.at.start as usize;
            assert_eq!(&source.text[start..start + word.at.length as usize], word.text);
        }
        (words.iter().map(|w| w.text.to_owned()).collect(), problems.has_errors())
    }

    #[test]
    fn comments_are_no_words() {
        let (found, bad) =
            texts("( ARRAY-dim FORM\n  # |  % )\n -arr- A/D-5 % rest ( of it\n(x)Y (-traj\n) Z");
        assert_eq!(found, ["-arr-", "A/D-5", "Y", "Z"]);
        assert!(!bad);
    }

    #[test]
    fn comments_do_not_nest() {
        // Figure VIII.12, line 6: the second parenthesis of `( 257 load (` opens nothing.
        let (found, bad) = texts("  256 load ( o-loc      )      ( 257 load (           )\n  252 load");
        assert_eq!(found, ["256", "load", "252", "load"]);
        assert!(!bad);
    }

    #[test]
    fn open_comment_is_an_error() {
        let (found, bad) = texts("A ( B\nC");
        assert_eq!(found, ["A"]);
        assert!(bad);
    }
}
