//! Reading, checking and linking task data (feature `load`).
//!
//! The stages are one module each, and every stage goes on after an error, so that one load shows all that is wrong:
//!
//! 1. [`source`]: files into blocks; [`lex`]: blocks into words;
//! 2. [`parse`], [`forms`] and [`guarded`]: words into [`entries`];
//! 3. [`directory`]: which blocks are loaded at all (Figure VIII.12);
//! 4. `link`: names into record numbers, duplicates, unknown names;
//! 5. `check`: what a command would run into; every place the robot is sent to can be reached;
//! 6. [`store`]: the files; [`origins`]: where each record was entered; [`report`]: everything that was found, with its
//!    [`places`].
//!
//! [`mod@print`] writes entries as forms again. [`job`] reads the job files, which stand beside the blocks.

mod check;
mod collected;
pub mod directory;
pub mod entries;
pub mod forms;
pub mod guarded;
mod index;
pub mod job;
pub mod lex;
mod link;
pub mod names;
pub mod origins;
mod orphans;
mod parallel;
pub mod parse;
pub mod places;
pub mod print;
pub mod report;
pub mod source;
pub mod store;

use std::path::Path;

pub use job::{Job, Step, ViseOpening, Workstation};
pub use origins::Origins;
pub use report::{Diagnostic, Diagnostics, Loaded, Severity};
pub use source::{BlockNumber, Source};
pub use store::Store;

use {places::Places, report::Problems};

impl Store {
    /// Load all files `*.blk` under a data directory.
    ///
    /// # Errors
    /// The report, if it holds an error; every error of the data is in it.
    pub fn load(directory: &Path) -> Result<(Self, Diagnostics), Box<Diagnostics>> {
        let (sources, unreadable) = source::read_blocks_under(directory);
        let mut problems = Problems::default();
        unreadable.iter().for_each(|(path, error)| problems.unreadable(path, error));
        Self::default().loaded_with(sources, problems)
    }

    /// Load texts that were read elsewhere, such as the attachments of a log.
    ///
    /// # Errors
    /// The report, if it holds an error; every error of the data is in it.
    pub fn from_sources(sources: Vec<Source>) -> Result<(Self, Diagnostics), Box<Diagnostics>> {
        Self::default().with_blocks(sources)
    }

    /// The next generation of the data: these data with more blocks loaded, while these stay as they are
    /// (docs/design/ownership.md "Reload").
    ///
    /// An entry that says again what an entry of these data says (a pose of the same name, the same grip of the same object
    /// at the same location …) replaces it and keeps its record number; other entries are appended. Nothing is removed, but
    /// for the locations of an object, which its newer object location entries replace together. Numbers of paths, their
    /// points and their parameters, which nobody knows by name, are given anew, and so are those of object locations.
    ///
    /// All blocks of the texts are loaded, as by `load` at a terminal, unless the texts have a root directory block; a
    /// directory may also name blocks that these data have. The whole of the new generation is checked, not only the new part.
    ///
    /// # Errors
    /// The report, if it holds an error; then there is no new generation.
    pub fn with_blocks(&self, texts: Vec<Source>) -> Result<(Self, Diagnostics), Box<Diagnostics>> {
        self.loaded_with(texts, Problems::default())
    }

    /// The next generation; errors are those of files that could not be read.
    fn loaded_with(
        &self,
        texts: Vec<Source>,
        problems: Problems,
    ) -> Result<(Self, Diagnostics), Box<Diagnostics>> {
        let (store, mut problems, blocks) = self.linked(texts, problems);
        if !problems.has_errors() {
            check::reach(&store.view(), &store.origins, &mut problems);
        }
        store.reported(self.sources.len(), problems, blocks)
    }

    /// The same as [`Store::with_blocks`], but the targets are not tried against the arm.
    ///
    /// # Errors
    /// The report, if it holds an error; then there is no new generation.
    pub fn with_blocks_untried(&self, texts: Vec<Source>) -> Result<(Self, Diagnostics), Box<Diagnostics>> {
        let (store, problems, blocks) = self.linked(texts, Problems::default());
        store.reported(self.sources.len(), problems, blocks)
    }

    /// Read, link and check all but the reach; gives the number of blocks that were read too.
    fn linked(&self, texts: Vec<Source>, mut problems: Problems) -> (Self, Problems, usize) {
        let incomplete = problems.has_errors();
        let first = self.sources.len();
        let mut sources = self.sources.clone();
        sources.extend(texts);
        let mut read = directory::read(&sources, first, &self.blocks, &mut problems);
        read.orphans.incomplete |= incomplete;
        let entries = self.entries.with(read.entries);
        let (files, indexes, origins) = link::link(&entries, read.broken, &mut read.orphans, &mut problems);
        read.orphans.report(&mut problems);
        let count = read.blocks.len();
        let blocks = self.blocks.union(&read.blocks).copied().collect();
        let store = Self { files, indexes, sources, entries, blocks, origins };
        // Records that name nothing are no use in further checks; the names come first.
        if !problems.has_errors() {
            check::check(&store.view(), &store.origins, &mut problems);
        }
        (store, problems, count)
    }

    /// The store and its report, or the report alone if it holds an error; `before` texts were there before.
    fn reported(
        self,
        before: usize,
        problems: Problems,
        blocks: usize,
    ) -> Result<(Self, Diagnostics), Box<Diagnostics>> {
        let failed = problems.has_errors();
        let loaded = if failed { Vec::new() } else { self.loaded() };
        let mut report = Diagnostics::new(problems, Places::in_blocks(&self.sources), blocks, loaded);
        report.files = self.sources.len() - before;
        if failed { Err(Box::new(report)) } else { Ok((self, report)) }
    }
}
