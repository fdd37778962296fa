//! The entries in the blocks of the task data, and which blocks load which.

use diagnostics::{BlockNumber, Problems};
use taskdata::load::{Store, entries::Entry, lex, parse::parse, source::blocks};

pub struct Entered {
    all: Vec<(BlockNumber, Entry)>,
    blocks: Vec<Loads>,
}

struct Loads {
    file: String,
    block: BlockNumber,
    named: Vec<BlockNumber>,
}

impl Entered {
    /// Read the blocks of task data that have no errors.
    pub fn of(store: &Store) -> Self {
        let mut entered = Self { all: Vec::new(), blocks: Vec::new() };
        for source in store.sources() {
            for block in blocks(0, source).0 {
                let mut problems = Problems::default();
                let words = lex::words(&block, &mut problems);
                let parsed = parse(&words, block.number, block.header, &mut problems);
                let named = parsed.loads.iter().map(|load| load.block).collect();
                entered.blocks.push(Loads { file: source.name.clone(), block: block.number, named });
                entered.all.extend(parsed.entries.into_iter().map(|entry| (block.number, entry)));
            }
        }
        entered
    }

    pub fn all(&self) -> impl Iterator<Item = &Entry> {
        self.all.iter().map(|(_, entry)| entry)
    }

    /// The block of the first entry for which `kind` is true.
    pub fn block_of(&self, kind: impl Fn(&Entry) -> bool) -> Option<BlockNumber> {
        self.all.iter().find(|(_, entry)| kind(entry)).map(|(block, _)| *block)
    }

    pub fn file(&self, block: BlockNumber) -> Option<&str> {
        self.blocks.iter().find(|loads| loads.block == block).map(|loads| loads.file.as_str())
    }

    /// The owners that contain a location point, with the blocks of their forms.
    pub fn owners_of(&self, point: &str) -> impl Iterator<Item = (BlockNumber, &str)> {
        self.all.iter().filter_map(move |(block, entry)| match entry {
            Entry::Owner(owner) if owner.members.iter().any(|member| member.name.name.as_str() == point) => {
                Some((*block, owner.name.name.as_str()))
            }
            _ => None,
        })
    }

    pub fn directory(&self, block: BlockNumber) -> Option<(&str, BlockNumber)> {
        let loads = self.blocks.iter().find(|loads| loads.named.contains(&block))?;
        Some((&loads.file, loads.block))
    }

    /// The first number of a sequence of `count` block numbers that are free in an area.
    pub fn free_blocks(&self, offset: u32, count: u32) -> Option<u32> {
        let used = |number: u32| {
            let block = BlockNumber { offset, number };
            self.blocks.iter().any(|loads| loads.block == block || loads.named.contains(&block))
        };
        let starts = (10..20).chain(4..10).map(|step| step * 50 + 1);
        starts.into_iter().find(|start| (*start..start + count).all(|number| !used(number)))
    }
}
