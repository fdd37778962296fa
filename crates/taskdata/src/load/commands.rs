//! Blocks of commands for Task at offset 16000 (IV.2.7, IV.3.3). A line that begins with `==` is a command, as in a
//! job; LINE-LOAD puts it into Task's command buffer. Other lines are comments.

use std::{
    collections::{BTreeMap, btree_map::Entry},
    fmt,
};

use diagnostics::{At, BlockNumber, Problems};

use super::{
    Store,
    job::{JobLine, OwnLineError, own_command},
    source::{BLOCK_LINES, Block},
};

pub const OFFSET: u32 = 16_000; // area of Task's blocks (IV.2.7)

#[derive(Clone, Debug)]
struct Lines {
    header: At,
    lines: Vec<(At, String)>, // from line 0
}

#[derive(Clone, Debug, Default)]
pub(super) struct Commands(BTreeMap<u32, Lines>);

/// Why LINE-LOAD finds no command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LineLoadError {
    NoBlock {
        number: u32,
        known: Vec<u32>,
    },
    Lines(usize, usize), // not in the block
    /// The lines contain no command, or several.
    Count {
        number: u32,
        lines: (usize, usize), // first and last
        found: usize,
    },
    Command(OwnLineError),
}

impl fmt::Display for LineLoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoBlock { number, known } => {
                let known: Vec<String> = known.iter().map(u32::to_string).collect();
                write!(f, "there is no block {number} at offset {OFFSET}; blocks with commands: ")?;
                f.write_str(if known.is_empty() { "none" } else { "" })?;
                f.write_str(&known.join(", "))
            }
            Self::Lines(from, to) => {
                let last = BLOCK_LINES - 1;
                write!(f, "two lines from 0 to {last} were expected, the first one first; found {from} {to}")
            }
            Self::Count { number, lines: (from, to), found } => {
                write!(f, "one command was expected in lines {from} to {to} of block {number}; found {found}")
            }
            Self::Command(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for LineLoadError {}

impl Commands {
    pub(super) fn add(&mut self, block: &Block<'_>, problems: &mut Problems) {
        match self.0.entry(block.number.number) {
            Entry::Occupied(first) => {
                let what = format!("{} is given twice", block.number);
                problems.duplicate(block.header, what, first.get().header);
            }
            Entry::Vacant(place) => {
                let lines = block.lines.iter().map(|line| (line.at, line.text.to_owned())).collect();
                place.insert(Lines { header: block.header, lines });
            }
        }
    }

    pub(super) fn numbers(&self) -> impl Iterator<Item = BlockNumber> {
        self.0.keys().map(|number| BlockNumber { offset: OFFSET, number: *number })
    }

    pub(super) fn with(&self, newer: Self) -> Self {
        let mut all = self.0.clone();
        all.extend(newer.0);
        Self(all)
    }

    /// Checks that each line is a comment, or a command with names of the task data.
    pub(super) fn check(&self, store: &Store, problems: &mut Problems) {
        for (at, text) in self.0.values().flat_map(|block| &block.lines) {
            let text = text.trim();
            if is_command(text) {
                if let Err(why) = own_command(text, store) {
                    problems.error("command.line", *at, why.to_string());
                }
            } else if !(text.is_empty() || text.starts_with(['%', '('])) {
                let help = format!("a block at offset {OFFSET} holds commands; forms are at other offsets");
                problems.error_help(
                    "command.line",
                    *at,
                    "a command `== ...` or a comment was expected",
                    help,
                );
            }
        }
    }
}

fn is_command(text: &str) -> bool {
    text.trim_start().starts_with("==")
}

impl Store {
    /// The command of `block from to LINE-LOAD` (IV.3.3).
    pub fn line_load(&self, number: u32, from: usize, to: usize) -> Result<JobLine, LineLoadError> {
        let known = || self.commands.0.keys().copied().collect();
        let block =
            self.commands.0.get(&number).ok_or_else(|| LineLoadError::NoBlock { number, known: known() })?;
        if from > to || to >= BLOCK_LINES {
            return Err(LineLoadError::Lines(from, to));
        }
        let lines = block.lines.iter().take(to + 1).skip(from);
        let commands: Vec<&str> =
            lines.map(|(_, text)| text.as_str()).filter(|text| is_command(text)).collect();
        match commands.as_slice() {
            [command] => own_command(command, self).map_err(LineLoadError::Command),
            _ => Err(LineLoadError::Count { number, lines: (from, to), found: commands.len() }),
        }
    }
}
