//! Block, line and column of a piece of text: computed from the text when a message needs it.

use std::collections::HashMap;

use crate::source::{At, BlockLines, BlockNumber, Source, lines_of};

/// A place in the numbers that messages show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Position {
    /// Block and offset, if the place is in a block.
    pub block: Option<BlockNumber>,
    /// Line in the block from 0 (as the manual counts), or line in the file from 1 if there is no block.
    pub line: u32,
    /// Column from 1, in characters.
    pub column: u32,
    /// First byte of the line in the source; in a listing, the first byte after the line number.
    pub begin: u32,
}

struct Lines<'s> {
    text: &'s str,
    blocks: Vec<BlockLines>,
    starts: Vec<u32>, // of the lines of the file
}

/// The places of pieces of some sources. Each source is scanned once, when its first piece is needed.
pub struct Places<'s> {
    sources: &'s [Source],
    blocks: Option<fn(&Source) -> Vec<BlockLines>>, // `None`: lines are counted in the file
    known: HashMap<u32, Lines<'s>>,
}

/// The last item that begins at or before `byte`. The items are in ascending order.
fn last_begun<T>(items: &[T], start: impl Fn(&T) -> u32, byte: u32) -> Option<usize> {
    items.partition_point(|item| start(item) <= byte).checked_sub(1)
}

fn short(value: usize) -> u32 {
    u32::try_from(value).unwrap_or(u32::MAX)
}

impl<'s> Places<'s> {
    /// Places in files of blocks, which `blocks` finds.
    #[must_use]
    pub fn in_blocks(sources: &'s [Source], blocks: fn(&Source) -> Vec<BlockLines>) -> Self {
        Self { sources, blocks: Some(blocks), known: HashMap::new() }
    }

    /// Places in files of lines, such as jobs.
    #[must_use]
    pub fn in_lines(sources: &'s [Source]) -> Self {
        Self { sources, blocks: None, known: HashMap::new() }
    }

    /// The sources.
    #[must_use]
    pub const fn sources(&self) -> &'s [Source] {
        self.sources
    }

    /// The source of a piece.
    #[must_use]
    pub fn source(&self, at: At) -> Option<&'s Source> {
        self.sources.get(usize::try_from(at.source).ok()?)
    }

    /// Position of the start of a piece; `None` if there is no such source.
    pub fn position(&mut self, at: At) -> Option<Position> {
        let source = self.source(at)?;
        let lines = self.known.entry(at.source).or_insert_with(|| Lines {
            text: &source.text,
            blocks: self.blocks.map(|blocks| blocks(source)).unwrap_or_default(),
            starts: lines_of(&source.text).map(|(start, _)| short(start)).collect(),
        });
        Some(lines.in_block(at.start).unwrap_or_else(|| lines.in_file(at.start)))
    }

    /// True if a remark directly above the line of a piece accepts the warning: `%% accepted CODE: the reason`.
    #[must_use]
    pub fn accepts(&self, at: Option<At>, code: &str) -> bool {
        let Some((at, source)) = at.and_then(|at| Some((at, self.source(at)?))) else { return false };
        let before = usize::try_from(at.start).ok().and_then(|start| source.text.get(..start));
        let mut above = before.unwrap_or_default().lines().rev();
        // The text before the piece in its line, unless the piece begins the line.
        if before.is_some_and(|before| !before.ends_with('\n')) {
            above.next();
        }
        let remarks = above.map_while(|line| line.trim_start().strip_prefix(['%', '#']));
        let accepted = |remark: &str| {
            let (word, reason) = remark.trim_start_matches('%').trim_start().split_once(code)?;
            Some(word == "accepted " && reason.strip_prefix(':').is_some_and(|why| !why.trim().is_empty()))
        };
        remarks.filter_map(accepted).any(|accepted| accepted)
    }

    /// A place as text: file, block and line.
    #[must_use]
    pub fn words(&mut self, at: At) -> String {
        let file = self.source(at).map_or("?", |source| source.name.as_str());
        match self.position(at) {
            Some(Position { block: Some(block), line, .. }) => format!("{file}, {block}, line {line}"),
            Some(Position { line, .. }) => format!("{file}, line {line}"),
            None => file.to_owned(),
        }
    }
}

impl Lines<'_> {
    /// `None` for headers and for text between the lines of a block.
    fn in_block(&self, byte: u32) -> Option<Position> {
        let block = self.blocks.get(last_begun(&self.blocks, |block| block.start, byte)?)?;
        let number = last_begun(&block.lines, |line| line.start, byte)?;
        let line = *block.lines.get(number)?;
        let within = byte.saturating_sub(line.start) <= line.length;
        within.then(|| Position {
            block: Some(block.number),
            line: short(number),
            column: self.column(line.start, byte),
            begin: line.start,
        })
    }

    fn in_file(&self, byte: u32) -> Position {
        let number = last_begun(&self.starts, |start| *start, byte).unwrap_or(0);
        let begin = self.starts.get(number).copied().unwrap_or(0);
        Position { block: None, line: short(number) + 1, column: self.column(begin, byte), begin }
    }

    fn column(&self, begin: u32, byte: u32) -> u32 {
        let long = |position: u32| usize::try_from(position).unwrap_or(usize::MAX);
        let before = self.text.get(long(begin)..long(byte)).unwrap_or_default();
        short(before.chars().count()) + 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_remark_above_a_line_accepts_a_warning_by_its_code_and_a_reason() {
        let accepts = |text: &str| {
            let start = short(text.find('X').unwrap());
            let sources = [Source { name: "f".to_owned(), text: text.into() }];
            Places::in_lines(&sources).accepts(Some(At { source: 0, start, length: 1 }), "pose.square")
        };
        assert!(accepts("%% accepted pose.square: printed so\n%% more\n  X"));
        assert!(accepts("# accepted pose.square: printed so\nX = 1"));
        for not in [
            "X",
            "%% accepted pose.square:\nX",
            "%% accepted reach: no\nX",
            "%% accepted pose.square: a\n\nX",
        ] {
            assert!(!accepts(not), "{not}");
        }
    }

    #[test]
    fn lines_count_from_1_and_columns_in_characters() {
        let sources = [Source { name: "cell.toml".to_owned(), text: "a = 1\nb = \"\u{b5}\" # c".into() }];
        let mut places = Places::in_lines(&sources);
        let found = places.position(At { source: 0, start: 13, length: 1 });
        assert_eq!(found, Some(Position { block: None, line: 2, column: 7, begin: 6 }));
        assert_eq!(places.words(At { source: 0, start: 13, length: 1 }), "cell.toml, line 2");
        assert_eq!(places.words(At { source: 1, start: 0, length: 1 }), "?");
    }
}
