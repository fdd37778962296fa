//! Which blocks are loaded: directory blocks, from the block with which the manual's boot begins (IV.2.10 steps 9 and 10).
//!
//! The boot loads blocks 905 and 906 at offset 21000 (system data) and block 0 at offset 20000 (objects); these name
//! further blocks with `n load` or `offset n OLOAD`, and so on. An area without such a root has no directory, and all its
//! blocks are loaded in the order in which they stand.

use std::collections::{BTreeSet, HashSet, hash_map::Entry};

use rustc_hash::FxHashMap;

use super::{
    collected::Collected,
    entries::LoadLine,
    lex, parallel,
    parse::{Parsed, parse},
    report::Problems,
    source::{At, BLOCK_COLUMNS, BLOCK_LINES, Block, BlockFault, BlockNumber, LAST_BLOCK, Source, blocks},
};

/// Blocks with which loading begins.
const ROOTS: [BlockNumber; 3] = [
    BlockNumber { offset: 21_000, number: 905 },
    BlockNumber { offset: 21_000, number: 906 },
    BlockNumber { offset: 20_000, number: 0 },
];

/// Blocks that one processor reads at a time.
const BLOCKS_AT_A_TIME: usize = 256;

/// What the loaded blocks hold.
#[derive(Debug, Default)]
pub(super) struct Read {
    /// Entries in the order in which they were loaded.
    pub(super) entries: Collected,
    /// Names in entries that could not be read.
    pub broken: HashSet<String>,
    /// Blocks that were loaded.
    pub blocks: BTreeSet<BlockNumber>,
}

/// Read the blocks that are to be loaded of all sources from position `first` on; `known` are those that were loaded before.
pub(super) fn read(
    sources: &[Source],
    first: usize,
    known: &BTreeSet<BlockNumber>,
    problems: &mut Problems,
) -> Read {
    let new = sources.get(first..).unwrap_or_default();
    let found = parallel::map(new.len(), |i| new.get(i).map(|source| blocks(first + i, source)));
    let mut all: FxHashMap<BlockNumber, Content> = FxHashMap::default();
    let mut order = Vec::new();
    for (found, faults) in found.into_iter().flatten() {
        for (at, fault) in faults {
            note(fault, at, problems);
        }
        for (block, content) in found.iter().zip(contents(&found)) {
            if let Entry::Vacant(e) = all.entry(block.number) {
                order.push(block.number);
                e.insert(content);
            } else {
                note(BlockFault::Duplicate, block.header, problems);
            }
        }
    }
    let mut loader = Loader { all, known, read: Read::default(), problems };
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

/// What a block holds, whether it is loaded or not, and what is wrong with it.
struct Content {
    header: At,
    parsed: Parsed,
    problems: Problems,
}

/// Read the words of all blocks.
fn contents(blocks: &[Block<'_>]) -> impl Iterator<Item = Content> + use<> {
    let read = |block: &Block<'_>| {
        let mut problems = Problems::default();
        let words = lex::words(block, &mut problems);
        let parsed = parse(&words, block.number, block.header, &mut problems);
        Content { header: block.header, parsed, problems }
    };
    let pieces = parallel::map_pieces(blocks.len(), BLOCKS_AT_A_TIME, |range| -> Vec<Content> {
        blocks.get(range).unwrap_or_default().iter().map(read).collect()
    });
    pieces.into_iter().flatten()
}

struct Loader<'b, 'p> {
    /// The blocks; those that were loaded are empty.
    all: FxHashMap<BlockNumber, Content>,
    known: &'b BTreeSet<BlockNumber>,
    read: Read,
    problems: &'p mut Problems,
}

impl Loader<'_, '_> {
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
        let Some(block) = self.all.get_mut(&number) else {
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
        let parsed = std::mem::take(&mut block.parsed);
        self.problems.append(&mut block.problems);
        parsed.entries.into_iter().for_each(|entry| self.read.entries.add(entry));
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
