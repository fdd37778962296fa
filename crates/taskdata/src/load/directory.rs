//! Selects the blocks to load by directory blocks (IV.2.10 steps 9 and 10). The boot loads blocks 905 and 906 at
//! offset 21000 (system data) and block 0 at offset 20000 (objects). These name further blocks with `n load` or
//! `offset n OLOAD`. An area without such a root has no directory: all its blocks are loaded in their order in the
//! files. Blocks at offset 16000 contain commands ([`commands`]).

use std::collections::{BTreeSet, HashSet};

use diagnostics::{At, BlockNumber, Problems, Source};
use rustc_hash::FxHashMap;

use super::{
    collected::Collected,
    commands::{self, Commands},
    entries::LoadLine,
    lex,
    orphans::Orphans,
    parallel,
    parse::{Parsed, parse},
    source::{BLOCK_COLUMNS, BLOCK_LINES, Block, BlockFault, LAST_BLOCK, blocks},
};

const ROOTS: [BlockNumber; 3] = [
    BlockNumber { offset: 21_000, number: 905 },
    BlockNumber { offset: 21_000, number: 906 },
    BlockNumber { offset: 20_000, number: 0 },
];

const BLOCKS_AT_A_TIME: usize = 256; // read by one processor at a time

#[derive(Debug, Default)]
pub(super) struct Read {
    pub(super) entries: Collected, // in the order of the load
    pub broken: HashSet<String>,   // names in entries that could not be read
    pub blocks: BTreeSet<BlockNumber>,
    pub orphans: Orphans,   // blocks that were not loaded, and numbers without a block
    pub commands: Commands, // need no directory
}

/// Reads the blocks to load from source `first` on; `known` blocks were loaded before.
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
    let (mut orphans, mut commands) = (Orphans::default(), Commands::default());
    for (source, (found, faults)) in found.into_iter().flatten().enumerate() {
        for (at, fault) in faults {
            note(fault, at, problems);
        }
        // The file of a reload may be empty.
        if found.is_empty() && first == 0 {
            let at = At { source: u32::try_from(first + source).unwrap_or(u32::MAX), ..At::default() };
            let help = "a block begins with a header like `BLOCK# 619 OFFSET 21000`; give the file another name if it holds none";
            problems.error_help("block.none", at, "this file has no block", help);
            orphans.incomplete = true;
        }
        let is_of_commands = |block: &Block<'_>| block.number.offset == commands::OFFSET;
        let (of_commands, found): (Vec<_>, Vec<_>) = found.into_iter().partition(is_of_commands);
        of_commands.iter().for_each(|block| commands.add(block, problems));
        for (block, content) in found.iter().zip(contents(&found)) {
            let first = all.get(&block.number).map(|first| first.header);
            if first.is_some() || block.number.offset == BlockNumber::UNREADABLE {
                orphans.add(block.number, block.header, content.parsed, first);
            } else {
                order.push(block.number);
                all.insert(block.number, content);
            }
        }
    }
    let blocks = commands.numbers().collect();
    let read = Read { blocks, orphans, commands, ..Read::default() };
    let mut loader = Loader { all, known, read, problems };
    loader.load_roots(&order);
    loader.unloaded(&order);
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
                "continue at the next offset, 1000 higher",
            );
            problems.expected(format!("from 0 to {LAST_BLOCK}"));
        }
        BlockFault::NoHeader => problems.error_help(
            "block.header",
            at,
            "this text is before the first block",
            "a block begins with a header like `BLOCK# 619 OFFSET 21000`; remarks on the file begin with %%",
        ),
        BlockFault::TooManyLines => problems.error_help(
            "block.lines",
            at,
            format!("a block has {BLOCK_LINES} lines, 0 to 15; this one has more"),
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
        BlockFault::Tab(lines) => {
            let (more, count) = match lines {
                1 => ("", "1 line has one".to_owned()),
                _ => (", the first of this file", format!("{lines} lines have some")),
            };
            problems.error_help(
                "block.tab",
                at,
                format!("a block has blanks, this line has a tab{more}"),
                format!("replace the tabs, {count}: `expand FILE`"),
            );
        }
    }
}

struct Content {
    header: At,
    parsed: Parsed,
    problems: Problems,
}

fn contents(blocks: &[Block<'_>]) -> impl Iterator<Item = Content> + use<> {
    let read = |block: &Block<'_>| {
        let mut problems = Problems::default();
        let words = lex::words(block, &mut problems);
        let open = problems.has_errors();
        let mut parsed = parse(&words, block.number, block.header, &mut problems);
        if open {
            // Words in an open comment, which is already reported, make no entries.
            let hidden = block.lines.iter().flat_map(|line| line.text.split_whitespace());
            parsed.broken.extend(hidden.map(str::to_owned));
        }
        Content { header: block.header, parsed, problems }
    };
    let pieces = parallel::map_pieces(blocks.len(), BLOCKS_AT_A_TIME, |range| -> Vec<Content> {
        blocks.get(range).unwrap_or_default().iter().map(read).collect()
    });
    pieces.into_iter().flatten()
}

struct Loader<'b, 'p> {
    all: FxHashMap<BlockNumber, Content>, // loaded ones without their contents
    known: &'b BTreeSet<BlockNumber>,
    read: Read,
    problems: &'p mut Problems,
}

impl Loader<'_, '_> {
    fn load_roots(&mut self, order: &[BlockNumber]) {
        let roots: Vec<BlockNumber> = ROOTS.into_iter().filter(|root| self.all.contains_key(root)).collect();
        let directed: BTreeSet<u32> = roots.iter().map(|root| root.offset).collect();
        let undirected = order.iter().copied().filter(|block| !directed.contains(&block.offset));
        // The stack reads a block where it is named, as in FORTH. A directory that names itself causes no endless loop.
        let mut open: Vec<(BlockNumber, Option<At>)> =
            roots.into_iter().chain(undirected).map(|b| (b, None)).collect();
        open.reverse();
        while let Some((number, named)) = open.pop() {
            let loads = self.load(number, named);
            open.extend(loads.into_iter().rev().map(|line| (line.block, Some(line.at))));
        }
    }

    /// Loads a block once. Returns the lines that name further blocks.
    fn load(&mut self, number: BlockNumber, named: Option<At>) -> Vec<LoadLine> {
        let Some(block) = self.all.get_mut(&number) else {
            let line = named.filter(|_| !self.known.contains(&number));
            self.read.orphans.missing.extend(line.map(|at| LoadLine { block: number, at }));
            return Vec::new();
        };
        if !self.read.blocks.insert(number) {
            self.read.orphans.again.extend(named.map(|at| LoadLine { block: number, at }));
            return Vec::new();
        }
        let parsed = std::mem::take(&mut block.parsed);
        self.problems.append(&mut block.problems);
        parsed.entries.into_iter().for_each(|entry| self.read.entries.add(entry));
        self.read.broken.extend(parsed.broken);
        if !parsed.loads.is_empty() {
            let named = parsed.loads.iter().map(|line| line.block).collect();
            self.read.orphans.directories.insert(number, named);
        }
        parsed.loads
    }

    fn unloaded(&mut self, order: &[BlockNumber]) {
        for number in order.iter().filter(|number| !self.read.blocks.contains(number)) {
            if let Some(block) = self.all.remove(number) {
                self.read.orphans.add(*number, block.header, block.parsed, None);
            }
        }
    }
}
