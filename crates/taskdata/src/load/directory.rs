//! Which blocks are loaded: directory blocks, from the block with which the manual's boot begins (IV.2.10 steps 9 and 10).
//!
//! The boot loads blocks 905 and 906 at offset 21000 (system data) and block 0 at offset 20000 (objects); these name
//! further blocks with `n load` or `offset n OLOAD`, and so on. An area without such a root has no directory, and all its
//! blocks are loaded in the order in which they stand.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use super::{
    entries::{Entry, LoadLine},
    lex,
    parse::parse,
    report::Problems,
    source::{At, BLOCK_COLUMNS, BLOCK_LINES, Block, BlockFault, BlockNumber, LAST_BLOCK, Source, blocks},
};

/// Blocks with which loading begins.
const ROOTS: [BlockNumber; 3] = [
    BlockNumber { offset: 21_000, number: 905 },
    BlockNumber { offset: 21_000, number: 906 },
    BlockNumber { offset: 20_000, number: 0 },
];

/// What the loaded blocks hold.
#[derive(Debug, Default)]
pub struct Read {
    /// Entries in the order in which they were loaded.
    pub entries: Vec<Entry>,
    /// Names in entries that could not be read.
    pub broken: HashSet<String>,
    /// Blocks that were loaded.
    pub blocks: BTreeSet<BlockNumber>,
}

/// Read the blocks that are to be loaded of all sources from position `first` on; `known` are those that were loaded before.
pub fn read(
    sources: &[Source],
    first: usize,
    known: &BTreeSet<BlockNumber>,
    problems: &mut Problems,
) -> Read {
    let mut all: BTreeMap<BlockNumber, Block<'_>> = BTreeMap::new();
    let mut order = Vec::new();
    for (index, source) in sources.iter().enumerate().skip(first) {
        let (found, faults) = blocks(index, source);
        for (at, fault) in faults {
            note(fault, at, problems);
        }
        for block in found {
            if let std::collections::btree_map::Entry::Vacant(e) = all.entry(block.number) {
                order.push(block.number);
                e.insert(block);
            } else {
                note(BlockFault::Duplicate, block.header, problems);
            }
        }
    }
    let mut loader = Loader { all: &all, known, read: Read::default(), problems };
    loader.load_roots(&order);
    loader.unloaded();
    loader.read
}

fn note(fault: BlockFault, at: At, problems: &mut Problems) {
    match fault {
        BlockFault::Header => {
            problems.error("block.header", at, "a header like `BLOCK# 619 OFFSET 21000` was expected");
        }
        BlockFault::Number(number) => {
            problems.error_help(
                "block.number",
                at,
                format!("the blocks of an offset are numbered 0 to {LAST_BLOCK}, {number} found"),
                "go on at the next offset, 1000 further",
            );
            problems.expected(format!("from 0 to {LAST_BLOCK}"));
        }
        BlockFault::NoHeader => problems.error_help(
            "block.header",
            at,
            "this text stands before the first block",
            "a block begins with a header like `BLOCK# 619 OFFSET 21000`; remarks on the file begin with %%",
        ),
        BlockFault::TooManyLines => problems.error_help(
            "block.lines",
            at,
            format!("a block has {BLOCK_LINES} lines, 0 to 15; this one goes on"),
            "begin another block; remarks that begin with %% are not counted",
        ),
        BlockFault::TooWide(columns) => {
            problems.error(
                "block.columns",
                at,
                format!("a line has {BLOCK_COLUMNS} columns, this one has {columns}"),
            );
        }
        BlockFault::NotAscii => {
            problems.error("block.character", at, "a block has printable ASCII characters and blanks only");
        }
        BlockFault::Duplicate => problems.error("block.duplicate", at, "this block is given twice"),
    }
}

struct Loader<'s, 'b, 'p> {
    all: &'b BTreeMap<BlockNumber, Block<'s>>,
    known: &'b BTreeSet<BlockNumber>,
    read: Read,
    problems: &'p mut Problems,
}

impl Loader<'_, '_, '_> {
    fn load_roots(&mut self, order: &[BlockNumber]) {
        let roots: Vec<BlockNumber> = ROOTS.into_iter().filter(|root| self.all.contains_key(root)).collect();
        let directed: BTreeSet<u32> = roots.iter().map(|root| root.offset).collect();
        let undirected = order.iter().copied().filter(|block| !directed.contains(&block.offset));
        // A stack of blocks still to be loaded, the next on top: a block is read where it is named, as FORTH does, but without
        // recursion, and a directory that names itself ends.
        let mut open: Vec<(BlockNumber, Option<At>)> =
            roots.into_iter().chain(undirected).map(|b| (b, None)).collect();
        open.reverse();
        while let Some((number, named)) = open.pop() {
            let loads = self.load(number, named);
            open.extend(loads.into_iter().rev().map(|line| (line.block, Some(line.at))));
        }
    }

    /// Load a block, unless it was; gives the blocks that it names.
    fn load(&mut self, number: BlockNumber, named: Option<At>) -> Vec<LoadLine> {
        let Some(block) = self.all.get(&number) else {
            if let Some(at) = named.filter(|_| !self.known.contains(&number)) {
                self.problems.error("block.missing", at, format!("there is no {number}"));
            }
            return Vec::new();
        };
        if !self.read.blocks.insert(number) {
            if let Some(at) = named {
                self.problems.warning("block.again", at, format!("{number} is loaded already"), None);
            }
            return Vec::new();
        }
        let words = lex::words(block, self.problems);
        let parsed = parse(&words, number, block.header, self.problems);
        self.read.entries.extend(parsed.entries);
        self.read.broken.extend(parsed.broken);
        parsed.loads
    }

    /// A block that no directory names would be missed silently.
    fn unloaded(&mut self) {
        // One whose number is refused cannot be named.
        for (number, block) in self.all.iter().filter(|(number, _)| number.number <= LAST_BLOCK) {
            if !self.read.blocks.contains(number) {
                self.problems.warning(
                    "block.unloaded",
                    block.header,
                    format!("{number} is not loaded: no directory block names it"),
                    Some(format!("add `{} load` to a directory block that is loaded", number.number)),
                );
            }
        }
    }
}
