//! From words to entries: the compiling words of chapter VII.
//!
//! A form is read as FORTH reads it, word by word, without regard to columns: a compiling word takes the words after it
//! (`-pt-`, `-obj-` …), or the numbers before it (`-pose-`, `-mtb-`). After an error the rest of the entry is skipped up to the
//! next compiling word or the next line that begins with a number, so that one mistake gives one message.

use std::{fmt::Display, ops::RangeInclusive};

use rcs_core::name::{Name, NameError};

use crate::files::RefType;

use super::{
    entries::{Entry, LoadLine, Named, Typed},
    forms, guarded,
    lex::Word,
    names::nearest,
    report::Problems,
    source::{At, BlockNumber},
};

/// Words that begin an entry or a part of one. None of them can be a name.
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

/// The entry cannot be read further; the problem is already noted.
#[derive(Clone, Copy, Debug)]
pub struct Skip;

/// What a block holds.
#[derive(Debug, Default)]
pub struct Parsed {
    /// Entries in their order.
    pub entries: Vec<Entry>,
    /// Blocks that it loads.
    pub loads: Vec<LoadLine>,
    /// Names that stand in entries that could not be read: asking for one of them is no second error.
    pub broken: Vec<String>,
}

/// A reader of the words of one block.
pub struct Parser<'a, 'p> {
    words: &'p [Word<'a>],
    next: usize,
    /// The first word of the entry that is read.
    start: usize,
    block: BlockNumber,
    end: At,
    problems: &'p mut Problems,
    flawed: bool,
}

/// Read the words of a block.
pub fn parse(words: &[Word<'_>], block: BlockNumber, header: At, problems: &mut Problems) -> Parsed {
    let end = words.last().map_or(header, |w| w.at);
    let mut parser = Parser { words, next: 0, start: 0, block, end, problems, flawed: false };
    let mut parsed = Parsed::default();
    while let Some(word) = parser.peek() {
        let start = parser.next;
        parser.start = start;
        parser.flawed = false;
        let entry = parser.entry(word, &mut parsed);
        if entry.is_err() {
            parser.recover(start);
        }
        match entry {
            Ok(Some(entry)) if !parser.flawed => parsed.entries.push(entry),
            Ok(None) if !parser.flawed => {}
            _ => {
                let read = parser.words.get(start..parser.next).unwrap_or_default();
                parsed.broken.extend(read.iter().map(|w| w.text.to_owned()));
            }
        }
    }
    parsed
}

/// True if a word is one of [`COMPILING_WORDS`].
#[must_use]
pub fn is_compiling_word(text: &str) -> bool {
    // Most names differ from all of them in the first character.
    text.starts_with(['-', ':', '>', '<', '=', 'F', 'E', 'l', 'L', 'O']) && COMPILING_WORDS.contains(&text)
}

/// True if a word is a whole number, with or without a sign.
#[must_use]
pub fn is_integer(text: &str) -> bool {
    let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
    !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit())
}

impl<'a> Parser<'a, '_> {
    /// The next word, without taking it.
    #[must_use]
    pub fn peek(&self) -> Option<Word<'a>> {
        self.words.get(self.next).copied()
    }

    /// The word after the next `ahead` words.
    #[must_use]
    pub fn peek_at(&self, ahead: usize) -> Option<Word<'a>> {
        self.words.get(self.next.saturating_add(ahead)).copied()
    }

    /// Take the next word.
    pub fn take(&mut self) -> Option<Word<'a>> {
        let word = self.peek()?;
        self.next += 1;
        Some(word)
    }

    /// Take the next word if it is this one.
    pub fn take_if(&mut self, text: &str) -> Option<Word<'a>> {
        if self.peek()?.text == text { self.take() } else { None }
    }

    /// Note an error that spoils the entry but lets it be read to its end.
    pub fn flaw(&mut self, code: &'static str, at: At, message: impl Into<String>, help: Option<String>) {
        self.flawed = true;
        self.problems.push(super::report::Severity::Error, code, at, message.into(), help);
    }

    /// Note that something else was expected here.
    pub fn expected(&mut self, what: &str) -> Skip {
        let start = self.words.get(self.start).map_or(self.end, |w| w.at);
        let (at, found) = match self.peek() {
            Some(word) if !self.is_next_entry(word) => (word.at, format!("{} found", word.text)),
            // What is missing is missing in the entry before.
            _ => (start.to(self.last_at()), "the entry ends before it".to_owned()),
        };
        self.problems.error("form.expected", at, format!("{what} was expected, {found}"));
        self.problems.expected(what);
        Skip
    }

    /// True if a word that was not expected begins another entry, and is not the first of its own.
    fn is_next_entry(&self, word: Word<'_>) -> bool {
        let begins = word.first && (is_compiling_word(word.text) || is_integer(word.text));
        self.next > self.start && (begins || BEGINNINGS.contains(&word.text))
    }

    /// Note the nearest word, of the sort `what`, to the one that was just complained of.
    pub fn nearest(&mut self, what: &str, word: &str) {
        self.problems.nearest(what, word);
    }

    /// A whole number in a range. One that is out of range is noted, and the entry is read on.
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

    /// A name. One that is too long is noted, and the entry is read on.
    pub fn name<const N: usize>(&mut self, what: impl Display) -> Result<Named<N>, Skip> {
        self.name_within(what, N)
    }

    /// A name of at most `most` characters.
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
            // Its character is noted as one that no block has.
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

    /// One of the type words `allowed`.
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

    /// A type and a name; the name is missing after `$$$`.
    pub fn typed(&mut self, what: &str, allowed: &[RefType]) -> Result<Typed, Skip> {
        let (kind, at) = self.kind(format_args!("type of {what}"), allowed)?;
        if kind == RefType::Any {
            return Ok(Typed { kind, name: Named { name: Name::clipped(kind.text()), at } });
        }
        let most = if matches!(kind, RefType::Object | RefType::View) { 16 } else { 10 };
        Ok(Typed { kind, name: self.name_within(what, most)? })
    }

    /// The last word that was taken.
    #[must_use]
    pub fn last_at(&self) -> At {
        self.next.checked_sub(1).and_then(|i| self.words.get(i)).map_or(self.end, |w| w.at)
    }

    /// Read a single word that was taken before.
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

    /// Skip an entry whose compiling word comes after its numbers: up to `word` and the `names` words after it, but not
    /// into the next entry that begins with a compiling word.
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

    /// One entry, one load line, or a word that makes nothing.
    fn entry(&mut self, word: Word<'a>, parsed: &mut Parsed) -> Result<Option<Entry>, Skip> {
        if is_integer(word.text) {
            return self.numbers_first(parsed);
        }
        // A heading that was not put into parentheses, as in Figure VIII.10.
        if word.text.starts_with('"') {
            self.next += 1;
            return Ok(None);
        }
        self.next += 1;
        match word.text {
            // Forms are always loaded into empty files, so there is nothing to erase; FDEF only chooses a vocabulary.
            "ERASE-MOVTAB" | "FDEF" => Ok(None),
            "-pt-" => forms::point_at(self, "location point").map(|e| Some(Entry::Locpt(e))),
            "-ar-" => forms::point_at(self, "array").map(|e| Some(Entry::ArrayAt(e))),
            "-arr-" => forms::array(self).map(Some),
            "-own-" => forms::owner(self).map(Some),
            "-traj" => forms::trajectory(self).map(Some),
            "-obj-" => forms::object(self).map(Some),
            "-o-loc-" => forms::object_location(self).map(Some),
            "-grip-" => forms::grip(self).map(Some),
            "-vu-" => forms::view(self).map(Some),
            "-appr" | "-dept" => forms::approach_depart(self, word).map(Some),
            "-file-" => forms::file(self).map(Some),
            "-sen-" => guarded::sensor(self).map(Some),
            "-rel-" => guarded::relative_move(self).map(Some),
            ":S" => forms::show(self).map(Some),
            "==" => {
                self.problems.error_help(
                    "form.command",
                    word.at,
                    "a command is no task data",
                    "commands stand in the job files, data/jobs/NAME.job",
                );
                Err(Skip)
            }
            _ => {
                self.next -= 1;
                let skip = self.expected("a compiling word or a number");
                let near = nearest(word.text, COMPILING_WORDS.iter().copied());
                if let Some(near) = near {
                    self.problems.nearest("compiling word", near);
                }
                self.next += 1;
                Err(skip)
            }
        }
    }

    /// Entries that begin with numbers: `n load`, `offset n OLOAD`, lines of movetables, poses.
    fn numbers_first(&mut self, parsed: &mut Parsed) -> Result<Option<Entry>, Skip> {
        let second = self.peek_at(1).map_or("", |w| w.text);
        let third = self.peek_at(2).map_or("", |w| w.text);
        if matches!(second, "load" | "LOAD") {
            let at = self.peek().map_or(self.end, |w| w.at);
            let number = self.integer("number of a block", 0..=999)?;
            self.next += 1;
            return self.load(self.block.offset, number, at, parsed);
        }
        if is_integer(second) && third == "OLOAD" {
            let at = self.peek().map_or(self.end, |w| w.at);
            let offset = self.integer("offset", 0..=99_000)?;
            let number = self.integer("number of a block", 0..=999)?;
            self.next += 1;
            return self.load(offset.unsigned_abs(), number, at, parsed);
        }
        if is_integer(second) { forms::pose(self).map(Some) } else { forms::movetable(self).map(Some) }
    }

    fn load(&mut self, offset: u32, number: i32, at: At, parsed: &mut Parsed) -> Result<Option<Entry>, Skip> {
        let at = at.to(self.last_at());
        parsed.loads.push(LoadLine { block: BlockNumber { offset, number: number.unsigned_abs() }, at });
        Ok(None)
    }

    /// Skip to where the next entry can begin.
    fn recover(&mut self, start: usize) {
        if self.next == start {
            self.next += 1;
        }
        while let Some(word) = self.peek() {
            if BEGINNINGS.contains(&word.text) || (word.first && is_integer(word.text)) {
                return;
            }
            self.next += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_compiling_word_is_one() {
        assert!(COMPILING_WORDS.iter().all(|word| is_compiling_word(word)));
        assert!(BEGINNINGS.iter().all(|word| is_compiling_word(word)));
        assert!(
            !is_compiling_word("HOME") && !is_compiling_word("-1050ty") && !is_compiling_word("FIX-1-SAFE")
        );
    }
}
