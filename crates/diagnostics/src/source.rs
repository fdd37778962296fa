//! Texts, places in them, and blocks, which number their own lines.

use std::{fmt, sync::Arc};

/// A file with its text.
#[derive(Clone, Debug)]
pub struct Source {
    /// Path of the file, as shown in messages.
    pub name: String,
    /// Text of the file.
    pub text: Arc<str>,
}

/// A piece of a source, to underline. Every loaded word has one, so it is small; [`crate::Places`] finds its line.
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
    /// The piece from the beginning of `self` to the end of `end`, in the same source.
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
    /// Number of the block.
    pub number: BlockNumber,
    /// First byte of its header.
    pub start: u32,
    /// Lines of the block, numbered from 0.
    pub lines: Vec<At>,
}

/// Each line of a text, without its line end, with the position of its first byte.
pub fn lines_of(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut start = 0;
    text.split_inclusive('\n').map(move |line| {
        let here = start;
        start += line.len();
        (here, line.trim_end_matches(['\n', '\r']))
    })
}
