//! The blocks of the task data, for listing at a terminal (IV.2.7).

use std::path::{Path, PathBuf};

use taskdata::load::{
    BlockNumber, Source, Store,
    source::{BLOCK_LINES, blocks, read_blocks_under},
};

use super::complete::Names;

/// The areas of the manual (IV.2.7), and their present contents.
pub static AREAS: [(u32, &str, &str); 11] = [
    (12_000, "Prim", "crates/levels/src/prim"),
    (16_000, "Task", "crates/levels/src/task; blocks of commands: data/commands.blk"),
    (17_000, "Subtask", "crates/levels/src/subtask"),
    (18_000, "E-move", "crates/levels/src/emove"),
    (19_000, "T3 Interface", "crates/levels/src/t3i, crates/depc"),
    (20_000, "objects", "data/objects"),
    (21_000, "system data", "data/*.blk"),
    (23_000, "Parts gripper", "crates/levels/src/grip"),
    (24_000, "Diagnostics", "crates/executive, this program"),
    (25_000, "Quick Change, grippers", "crates/levels/src/quick_change, jaws"),
    (27_000, "Graphics", "this program, screen 1"),
];

const FOUND: usize = 12; // largest number of results of a search

/// Blocks, which are read at the first request.
#[derive(Default)]
pub struct Library {
    directory: PathBuf,
    read: Option<Vec<Source>>,
    names: Option<Names>,
    store: Option<Store>,
}

impl Library {
    #[must_use]
    pub fn of(directory: PathBuf) -> Self {
        Self { directory, ..Self::default() }
    }

    /// Blocks from another source, such as a log.
    #[must_use]
    pub fn with(sources: Vec<Source>) -> Self {
        Self { read: Some(sources), ..Self::default() }
    }

    #[must_use]
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// Read the directory again at the next request.
    pub fn forget(&mut self) {
        if !self.directory.as_os_str().is_empty() {
            (self.read, self.names, self.store) = (None, None, None);
        }
    }

    pub fn names(&mut self) -> &Names {
        let directory = self.directory.clone();
        if self.names.is_none() {
            self.names = Some(Names::of(self.sources(), &directory));
        }
        self.names.get_or_insert_default()
    }

    /// The records of the blocks, numbered as in the run; `None` without blocks.
    pub fn store(&mut self) -> Option<&Store> {
        if self.store.is_none() && !self.sources().is_empty() {
            self.store = Some(Store::from_sources_with_faults(self.sources().to_vec()).0);
        }
        self.store.as_ref()
    }

    pub fn sources(&mut self) -> &[Source] {
        let directory = &self.directory;
        self.read.get_or_insert_with(|| read_blocks_under(directory).0)
    }

    /// The lines of a block, from line 0, and its file. If several blocks have the number, the newest is used.
    pub fn block(&mut self, number: BlockNumber) -> Option<(String, Vec<String>)> {
        self.sources().iter().rev().find_map(|source| {
            let (found, _) = blocks(0, source);
            let block = found.into_iter().find(|block| block.number == number)?;
            let mut lines: Vec<String> = block.lines.iter().map(|line| line.text.to_owned()).collect();
            lines.resize(lines.len().max(BLOCK_LINES), String::new());
            Some((source.name.clone(), lines))
        })
    }

    pub fn numbers(&mut self, offset: u32) -> Vec<u32> {
        let mut numbers: Vec<u32> = self
            .sources()
            .iter()
            .flat_map(|source| blocks(0, source).0)
            .filter(|block| block.number.offset == offset)
            .map(|block| block.number.number)
            .collect();
        numbers.sort_unstable();
        numbers.dedup();
        numbers
    }

    /// The occurrences of a word: block, line, and text of the line.
    pub fn find(&mut self, word: &str) -> Vec<(BlockNumber, usize, String)> {
        let of_block = |block: taskdata::load::source::Block<'_>| {
            let holds = |text: &str| text.split_whitespace().any(|found| found.trim_matches('"') == word);
            let lines = block.lines.iter().enumerate().filter(|(_, line)| holds(line.text));
            lines.map(|(at, line)| (block.number, at, line.text.trim().to_owned())).collect::<Vec<_>>()
        };
        let all = self.sources().iter().flat_map(|source| blocks(0, source).0).flat_map(of_block);
        all.take(FOUND).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn library() -> Library {
        Library::of(Path::new(env!("CARGO_MANIFEST_DIR")).join("../data"))
    }

    #[test]
    fn blocks_of_two_areas_may_share_a_number() {
        let mut library = library();
        let line = |library: &mut Library, offset| {
            library.block(BlockNumber { offset, number: 863 }).map(|(file, lines)| (file, lines[12].clone()))
        };
        let (file, pause) = line(&mut library, 16_000).unwrap();
        assert_eq!((file.as_str(), pause.as_str()), ("commands.blk", "== PAUSE -- +0 -- 0 +0 -- 0 -- 0"));
        assert_eq!(line(&mut library, 21_000).unwrap().0, "trajectories.blk");
        assert_eq!(line(&mut library, 12_000), None);
        assert_eq!(library.numbers(16_000), [667, 863, 893]);
    }

    #[test]
    fn word_search_returns_its_places() {
        let found = library().find("SAFE-P");
        assert!(
            found.iter().any(|(block, _, text)| block.number == 610 && text.contains("-pose-")),
            "{found:?}"
        );
        assert!(library().find("NO-SUCH-WORD").is_empty());
        assert!(library().find("HOME").len() <= FOUND);
    }
}
