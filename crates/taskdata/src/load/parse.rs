//! From words to entries: the compiling words of chapter VII.
//!
//! A form is read as in FORTH, word by word. A compiling word takes the words after it (`-pt-`, `-obj-` …), or the
//! numbers before it (`-pose-`, `-mtb-`). After an error the entry is skipped up to the next compiling word or the
//! next line that begins with a number: one error gives one message.

use diagnostics::{At, BlockNumber, Problems, nearest};

use super::{
    entries::{Entry, LoadLine},
    forms, guarded,
    lex::Word,
    parser::{BEGINNINGS, COMPILING_WORDS, Parser, Skip, is_integer},
    show,
};

#[derive(Debug, Default)]
pub struct Parsed {
    pub entries: Vec<Entry>,  // in order
    pub loads: Vec<LoadLine>, // name blocks to load
    pub broken: Vec<String>,  // in unreadable entries, whose use is not a second error
}

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

impl<'a> Parser<'a, '_> {
    fn entry(&mut self, word: Word<'a>, parsed: &mut Parsed) -> Result<Option<Entry>, Skip> {
        if is_integer(word.text) {
            return self.numbers_first(parsed);
        }
        // A heading without parentheses (Figure VIII.10).
        if word.text.starts_with('"') {
            self.next += 1;
            return Ok(None);
        }
        self.next += 1;
        match word.text {
            // Forms are loaded into empty files, so ERASE-MOVTAB has no effect. FDEF only selects a vocabulary.
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
            ":S" => show::show(self).map(Some),
            "==" => {
                self.problems.error_help(
                    "form.command",
                    word.at,
                    "a command is not task data",
                    "commands belong in the job files, data/jobs/NAME.job",
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

    /// `n load`, `offset n OLOAD`, lines of movetables, poses.
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
