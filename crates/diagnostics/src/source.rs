//! Texts, pieces of them, and blocks whose lines have numbers of their own.

use std::{fmt, sync::Arc};

/// A file with its text.
#[derive(Clone, Debug)]
pub struct Source {
    /// Path as it is shown.
    pub name: String,
    /// Its text.
    pub text: Arc<str>,
}

/// A piece of a source: what a diagnostic underlines. Every word of a load has one, so it is small; [`crate::Places`]
/// knows its block, line and column.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct At {
    /// Position of the source in the list of sources.
    pub source: u32,
    /// First byte in the source.
    pub start: u32,
    /// Number of bytes.
    pub length: u32,
}

impl At {
    /// From the beginning of one piece to the end of another of the same source.
    #[must_use]
    pub fn to(self, end: Self) -> Self {
        let last = end.start.saturating_add(end.length);
        Self { length: last.saturating_sub(self.start).max(self.length), ..self }
    }
}

/// Number of a block and the offset of its area.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BlockNumber {
    /// `OFFSET`: 20000 objects, 21000 system data (IV.2.7).
    pub offset: u32,
    /// `BLOCK#`.
    pub number: u32,
}

impl BlockNumber {
    /// The offset of a block whose header cannot be read.
    pub const UNREADABLE: u32 = u32::MAX;
}

impl fmt::Display for BlockNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "block {} (offset {})", self.number, self.offset)
    }
}

/// The lines of a block in its source.
#[derive(Clone, Debug)]
pub struct BlockLines {
    /// Which block.
    pub number: BlockNumber,
    /// First byte of its header.
    pub start: u32,
    /// Its lines, counted from 0.
    pub lines: Vec<At>,
}

/// Each line of a text with the position of its first byte.
pub fn lines_of(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut start = 0;
    text.split_inclusive('\n').map(move |line| {
        let here = start;
        start += line.len();
        (here, line.trim_end_matches(['\n', '\r']))
    })
}
