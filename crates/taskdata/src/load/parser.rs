use std::{fmt::Display, ops::RangeInclusive};

use diagnostics::{At, BlockNumber, Problems, Severity};
use rcs_core::name::{Name, NameError};

use crate::files::RefType;

use super::{
    entries::{Named, Typed},
    lex::Word,
};

/// They begin an entry or a part of one, and cannot be names.
pub const COMPILING_WORDS: &[&str] = &[
    "-pose-",
    "----",
    "-mtb-",
    "-pt-",
    "-arr-",
    "-ar-",
    "-own-",
    "-m-",
    "-traj",
    "-ppt",
    "-obj-",
    "-o-loc-",
    "-grip-",
    "-vu-",
    "-appr",
    "-dept",
    "-sen-",
    "-rel-",
    "-file-",
    ":S",
    ":R",
    ">FILE",
    "<=",
    "FDEF",
    "ERASE-MOVTAB",
    "==",
    "load",
    "LOAD",
    "OLOAD",
];

/// Words with which an entry can begin.
pub const BEGINNINGS: &[&str] = &[
    "-pt-",
    "-arr-",
    "-ar-",
    "-own-",
    "-traj",
    "-obj-",
    "-o-loc-",
    "-grip-",
    "-vu-",
    "-appr",
    "-dept",
    "-sen-",
    "-rel-",
    "-file-",
    ":S",
    "FDEF",
    "ERASE-MOVTAB",
    "==",
];

#[derive(Clone, Copy, Debug)]
pub struct Skip; // the rest of the entry is unreadable; the error is already reported

pub struct Parser<'a, 'p> {
    pub(super) words: &'p [Word<'a>],
    pub(super) next: usize,
    pub(super) start: usize, // of the present entry
    pub(super) block: BlockNumber,
    pub(super) end: At,
    pub(super) problems: &'p mut Problems,
    pub(super) flawed: bool,
}

#[must_use]
pub fn is_compiling_word(text: &str) -> bool {
    // The first character excludes most names.
    text.starts_with(['-', ':', '>', '<', '=', 'F', 'E', 'l', 'L', 'O']) && COMPILING_WORDS.contains(&text)
}

/// True for a whole number, with or without a sign.
#[must_use]
pub fn is_integer(text: &str) -> bool {
    let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
    !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit())
}

impl<'a> Parser<'a, '_> {
    #[must_use]
    pub fn peek(&self) -> Option<Word<'a>> {
        self.words.get(self.next).copied()
    }

    #[must_use]
    pub fn peek_at(&self, ahead: usize) -> Option<Word<'a>> {
        self.words.get(self.next.saturating_add(ahead)).copied()
    }

    pub fn take(&mut self) -> Option<Word<'a>> {
        let word = self.peek()?;
        self.next += 1;
        Some(word)
    }

    pub fn take_if(&mut self, text: &str) -> Option<Word<'a>> {
        if self.peek()?.text == text { self.take() } else { None }
    }

    pub fn flaw(&mut self, code: &'static str, at: At, message: impl Into<String>, help: Option<String>) {
        self.flawed = true;
        self.problems.push(Severity::Error, code, at, message.into(), help);
    }

    pub fn expected(&mut self, what: &str) -> Skip {
        let start = self.words.get(self.start).map_or(self.end, |w| w.at);
        let (at, found) = match self.peek() {
            Some(word) if !self.is_next_entry(word) => (word.at, format!("{} found", word.text)),
            // The missing part belongs to the previous entry.
            _ => (start.to(self.last_at()), "the entry ends before it".to_owned()),
        };
        self.problems.error("form.expected", at, format!("{what} was expected, {found}"));
        self.problems.expected(what);
        Skip
    }

    fn is_next_entry(&self, word: Word<'_>) -> bool {
        let begins = word.first && (is_compiling_word(word.text) || is_integer(word.text));
        self.next > self.start && (begins || BEGINNINGS.contains(&word.text))
    }

    /// Adds the nearest known word to the last report; `what` is its kind.
    pub fn nearest(&mut self, what: &str, word: &str) {
        self.problems.nearest(what, word);
    }

    /// A number out of range is reported, and reading continues.
    pub fn integer(&mut self, what: impl Display, range: RangeInclusive<i32>) -> Result<i32, Skip> {
        let Some(word) = self.peek().filter(|w| is_integer(w.text)) else {
            return Err(self.expected(&what.to_string()));
        };
        self.next += 1;
        match word.text.parse::<i32>() {
            Ok(value) if range.contains(&value) => Ok(value),
            _ => {
                let message =
                    format!("{what} is from {} to {}, {} found", range.start(), range.end(), word.text);
                self.flaw("value.range", word.at, message, None);
                self.problems.expected(format!("from {} to {}", range.start(), range.end()));
                Ok(*range.start())
            }
        }
    }

    /// A name that is too long is reported, and reading continues.
    pub fn name<const N: usize>(&mut self, what: impl Display) -> Result<Named<N>, Skip> {
        self.name_within(what, N)
    }

    fn name_within<const N: usize>(&mut self, what: impl Display, most: usize) -> Result<Named<N>, Skip> {
        let Some(word) = self.peek().filter(|w| !is_compiling_word(w.text) && !is_integer(w.text)) else {
            return Err(self.expected(&what.to_string()));
        };
        self.next += 1;
        let found = word.text.len();
        let read = match Name::<N>::new(word.text) {
            Ok(_) if found > most => Err(NameError::TooLong { allowed: most, found }),
            read => read,
        };
        let name = read.unwrap_or_else(|error| {
            // The wrong character is already reported, as an error of the block.
            if !word.text.is_ascii() {
                self.flawed = true;
                return Name::clipped("?");
            }
            let message = match error {
                NameError::TooLong { found, .. } => {
                    format!("{what} has at most {most} characters, {} has {found}", word.text)
                }
                NameError::BadCharacter { .. } => format!("{what}: {error}"),
            };
            self.flaw("name.length", word.at, message, None);
            Name::clipped(word.text)
        });
        Ok(Named { name, at: word.at })
    }

    pub fn kind(&mut self, what: impl Display, allowed: &[RefType]) -> Result<(RefType, At), Skip> {
        let found = self.peek().and_then(|w| {
            // The manual calls the type both `own` and `owner` (V.2.2).
            let text = if w.text == "owner" { "own" } else { w.text };
            RefType::from_text(text).filter(|k| allowed.contains(k)).map(|k| (k, w.at))
        });
        let Some(found) = found else {
            let words: Vec<&str> = allowed.iter().map(|k| k.text()).collect();
            return Err(self.expected(&format!("{what} ({})", words.join(", "))));
        };
        self.next += 1;
        Ok(found)
    }

    /// A type and a name; `$$$` has no name.
    pub fn typed(&mut self, what: &str, allowed: &[RefType]) -> Result<Typed, Skip> {
        let (kind, at) = self.kind(format_args!("type of {what}"), allowed)?;
        if kind == RefType::Any {
            return Ok(Typed { kind, name: Named { name: Name::clipped(kind.text()), at } });
        }
        let most = if matches!(kind, RefType::Object | RefType::View) { 16 } else { 10 };
        Ok(Typed { kind, name: self.name_within(what, most)? })
    }

    #[must_use]
    pub fn last_at(&self) -> At {
        self.next.checked_sub(1).and_then(|i| self.words.get(i)).map_or(self.end, |w| w.at)
    }

    pub fn at_word<T>(
        &mut self,
        word: Word<'_>,
        read: impl FnOnce(&mut Parser<'_, '_>) -> Result<T, Skip>,
    ) -> Result<T, Skip> {
        let words = [word];
        let mut one = Parser {
            words: &words,
            next: 0,
            start: 0,
            block: self.block,
            end: word.at,
            problems: self.problems,
            flawed: self.flawed,
        };
        let result = read(&mut one);
        self.flawed = one.flawed;
        result
    }

    /// Skips an entry whose compiling word follows its numbers: to `word` and the `names` words after it, but not into
    /// the next entry that begins with a compiling word.
    pub fn skip_past(&mut self, word: &str, names: usize) {
        while let Some(next) = self.peek() {
            if BEGINNINGS.contains(&next.text) {
                return;
            }
            self.next += 1;
            if next.text == word {
                self.next = self.next.saturating_add(names).min(self.words.len());
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_beginning_is_a_compiling_word() {
        assert!(COMPILING_WORDS.iter().all(|word| is_compiling_word(word)));
        assert!(BEGINNINGS.iter().all(|word| is_compiling_word(word)));
        assert!(
            !is_compiling_word("HOME") && !is_compiling_word("-1050ty") && !is_compiling_word("FIX-1-SAFE")
        );
    }
}
