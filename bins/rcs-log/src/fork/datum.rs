//! A changed word of the task data, written as `poses.blk:612:4-6:3+=20`.
//!
//! File, block and line as `rcs-log why` prints them: lines of a block count from 0, words from 1.

use std::{fmt, str::FromStr};

use taskdata::load::{BlockNumber, Source, Store, source::blocks};

const NAME: &str = "fork.blk"; // name under which the changed blocks are loaded

const EXPECTED: &str = "FILE:BLOCK:LINE[-LINE]:WORD=VALUE was expected, such as poses.blk:612:4-6:3+=20";

/// A change of a word in some lines of a block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Datum {
    file: String,
    block: u32,
    lines: [usize; 2],
    word: usize,
    edit: Edit,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Edit {
    Set(String),
    Add(i64),
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DatumError {
    #[error("the log has no file {file}: it has {known}")]
    File { file: String, known: String },
    #[error("{file} has no block {block}")]
    Block { file: String, block: u32 },
    #[error("{block} of {file} has no line {line}: its last is {last}")]
    Line {
        file: String,
        block: BlockNumber,
        line: usize,
        last: usize, // number of the last line
    },
    #[error("line {line} has no word {word}: it is `{text}`")]
    Word { line: usize, word: usize, text: String },
    #[error("word {word} of line {line} is {found}: += and -= need a whole number")]
    NoNumber { line: usize, word: usize, found: String },
}

impl FromStr for Datum {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("{EXPECTED}; found {text}");
        let (place, value) = text.split_once('=').ok_or_else(wrong)?;
        let (place, value) = (place.trim_end(), value.trim());
        let number =
            || value.parse::<i64>().map_err(|_| format!("{EXPECTED}; {value} is not a whole number"));
        let (place, edit) = match (place.strip_suffix('+'), place.strip_suffix('-')) {
            (Some(place), _) => (place, Edit::Add(number()?)),
            (None, Some(place)) => (place, Edit::Add(-number()?)),
            (None, None) => (place, Edit::Set(value.to_owned())),
        };
        if value.is_empty() || value.contains(char::is_whitespace) {
            return Err(wrong());
        }
        let mut parts = place.rsplitn(4, ':');
        let (Some(word), Some(lines), Some(block), Some(file)) =
            (parts.next(), parts.next(), parts.next(), parts.next())
        else {
            return Err(wrong());
        };
        let (first, last) = lines.split_once('-').unwrap_or((lines, lines));
        let whole = |text: &str| text.parse::<usize>().map_err(|_| wrong());
        let (lines, word) = ([whole(first)?, whole(last)?], whole(word)?);
        if word == 0 || lines[0] > lines[1] {
            return Err(wrong());
        }
        let block = block.parse().map_err(|_| wrong())?;
        Ok(Self { file: file.to_owned(), block, lines, word, edit })
    }
}

struct Changed {
    file: String,
    number: BlockNumber,
    lines: Vec<String>,
}

/// Blocks of task data with changed words.
#[derive(Default)]
pub struct Words(Vec<Changed>);

impl Words {
    /// Changes a word, in addition to all changes so far. `+=` and `-=` need a number.
    pub fn change(&mut self, store: &Store, datum: &Datum) -> Result<(), DatumError> {
        let known = |changed: &Changed| changed.file == datum.file && changed.number.number == datum.block;
        if let Some(block) = self.0.iter_mut().find(|changed| known(changed)) {
            return datum.apply(block);
        }
        let mut block = find(store.sources(), datum)?;
        datum.apply(&mut block)?;
        self.0.push(block);
        Ok(())
    }

    /// All changed blocks as one source; `None` without a change.
    #[must_use]
    pub fn source(&self) -> Option<Source> {
        if self.0.is_empty() {
            return None;
        }
        let text = self.0.iter().map(|Changed { number: BlockNumber { number, offset }, lines, .. }| {
            format!("BLOCK# {number} OFFSET {offset}\n{}\n", lines.join("\n"))
        });
        Some(Source { name: NAME.to_owned(), text: text.collect::<String>().into() })
    }
}

/// The block of a datum. If several blocks have its number, the newest is used.
fn find(sources: &[Source], datum: &Datum) -> Result<Changed, DatumError> {
    let Datum { file, block, .. } = datum;
    let of_name: Vec<&Source> = sources.iter().filter(|source| source.name == *file).collect();
    if of_name.is_empty() {
        let known: Vec<&str> = sources.iter().map(|source| source.name.as_str()).collect();
        return Err(DatumError::File { file: file.clone(), known: known.join(", ") });
    }
    let found = of_name.iter().rev().find_map(|source| {
        let (found, _) = blocks(0, source);
        found.into_iter().rev().find(|found| found.number.number == *block)
    });
    let found = found.ok_or_else(|| DatumError::Block { file: file.clone(), block: *block })?;
    let lines = found.lines.iter().map(|line| line.text.to_owned()).collect();
    Ok(Changed { file: file.clone(), number: found.number, lines })
}

impl Datum {
    fn apply(&self, block: &mut Changed) -> Result<(), DatumError> {
        let last = block.lines.len().saturating_sub(1);
        for at in self.lines[0]..=self.lines[1] {
            let Some(line) = block.lines.get_mut(at) else {
                return Err(DatumError::Line {
                    file: self.file.clone(),
                    block: block.number,
                    line: at,
                    last,
                });
            };
            *line = self.edited(at, line)?;
        }
        Ok(())
    }

    /// The line with its word replaced. A longer word extends into the blanks before it.
    fn edited(&self, at: usize, line: &str) -> Result<String, DatumError> {
        let missing = || DatumError::Word { line: at, word: self.word, text: line.trim().to_owned() };
        let found = line.split_whitespace().nth(self.word - 1).ok_or_else(missing)?;
        let start = found.as_ptr().addr() - line.as_ptr().addr();
        let new = match &self.edit {
            Edit::Set(value) => value.clone(),
            Edit::Add(by) => {
                let no_number =
                    || DatumError::NoNumber { line: at, word: self.word, found: found.to_owned() };
                let number: i64 = found.parse().map_err(|_| no_number())?;
                let sum = number.checked_add(*by).ok_or_else(no_number)?;
                let width = if found.starts_with('0') { found.len() } else { 0 };
                format!("{sum:0width$}")
            }
        };
        let (before, after) = (&line[..start], &line[start + found.len()..]);
        let room = new.len().saturating_sub(found.len());
        let blanks = before.len() - before.trim_end().len();
        let before = &before[..before.len() - room.min(blanks.saturating_sub(1))];
        let fill = " ".repeat(found.len().saturating_sub(new.len()));
        Ok(format!("{before}{fill}{new}{after}"))
    }
}

impl fmt::Display for Datum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, block, lines: [first, last], word, edit } = self;
        let lines = if first == last { format!("line {first}") } else { format!("lines {first} to {last}") };
        write!(f, "{file}, block {block}, {lines}, word {word}: ")?;
        match edit {
            Edit::Set(value) => write!(f, "{value}"),
            Edit::Add(by) => write!(f, "{by:+}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edited(change: &str, line: &str) -> Result<String, DatumError> {
        change.parse::<Datum>().unwrap().edited(4, line)
    }

    #[test]
    fn a_word_keeps_its_column() {
        let line = "   -6650     -550    -1400   -pose-   ...         UT-1-P";
        assert_eq!(
            edited("poses.blk:612:4:3+=20", line).unwrap(),
            "   -6650     -550    -1380   -pose-   ...         UT-1-P"
        );
        assert_eq!(
            edited("poses.blk:612:4:2-=9450", line).unwrap(),
            "   -6650   -10000    -1400   -pose-   ...         UT-1-P"
        );
        assert_eq!(edited("o.blk:253:8:4=20", "-obj-  X  2  0300").unwrap(), "-obj-  X  2    20");
        assert_eq!(edited("o.blk:253:8:4+=20", "-obj-  X  2  0300").unwrap(), "-obj-  X  2  0320");
    }

    #[test]
    fn missing_items_are_named() {
        let line = "-obj-  X  2";
        let text = |change| edited(change, line).unwrap_err().to_string();
        assert_eq!(text("o.blk:253:4:4=1"), "line 4 has no word 4: it is `-obj-  X  2`");
        assert_eq!(text("o.blk:253:4:2+=1"), "word 2 of line 4 is X: += and -= need a whole number");
    }

    #[test]
    fn a_place_has_four_parts() {
        for wrong in
            ["poses.blk:612:4=1", "poses.blk:612:4:0=1", "p:1:3-2:1=1", "p:1:1:1", "p:1:1:1=", "p:1:1:1+=x"]
        {
            assert!(wrong.parse::<Datum>().is_err(), "{wrong}");
        }
        assert_eq!(
            "a/b.blk:612:4-6:3-=20".parse::<Datum>().unwrap().to_string(),
            "a/b.blk, block 612, lines 4 to 6, word 3: -20"
        );
    }

    #[test]
    fn changed_block_contains_all_its_changes() {
        let text = "BLOCK# 7 OFFSET 21000\n%% remark\n  1  2\n  3  4\nBLOCK# 8 OFFSET 21000\n  5\n";
        let sources = [Source { name: "f.blk".to_owned(), text: text.into() }];
        let datum: Datum = "f.blk:7:1:2=40".parse().unwrap();
        let mut block = find(&sources, &datum).unwrap();
        datum.apply(&mut block).unwrap();
        assert_eq!(block.lines, ["  1  2", "  3 40"]);
        let error = "f.blk:7:2:1=0".parse::<Datum>().unwrap().apply(&mut block).unwrap_err();
        assert_eq!(error.to_string(), "block 7 (offset 21000) of f.blk has no line 2: its last is 1");
        let error = find(&sources, &"f.blk:9:1:2=40".parse().unwrap()).err().unwrap();
        assert_eq!(error.to_string(), "f.blk has no block 9");
    }
}
