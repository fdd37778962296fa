//! Reading, checking and linking task data (feature `load`).
//!
//! The stages are one module each, and every stage goes on after an error, so that one load shows all that is wrong:
//!
//! 1. [`source`]: files into blocks; [`lex`]: blocks into words;
//! 2. [`parse`], [`forms`] and [`guarded`]: words into [`entries`];
//! 3. [`directory`]: which blocks are loaded at all (Figure VIII.12);
//! 4. `link`: names into record numbers, duplicates, unknown names;
//! 5. `check`: errors that a command would meet; the robot can reach every target;
//! 6. [`store`]: the files; [`origins`]: where each record was entered; [`Diagnostics`]: everything that was found, with
//!    its place.
//!
//! [`mod@print`] writes entries as forms again. [`job`] reads the job files, which stand beside the blocks, and
//! [`commands`] the blocks with commands for Task.

pub mod alike;
mod check;
mod collected;
pub mod commands;
pub mod directory;
pub mod entries;
pub mod forms;
pub mod guarded;
mod index;
pub mod job;
pub mod lex;
mod link;
pub mod origins;
mod orphans;
mod parallel;
pub mod parse;
pub mod parser;
pub mod print;
pub mod show;
pub mod source;
pub mod store;

use std::{collections::HashSet, path::Path};

use diagnostics::Problems;
pub use diagnostics::{At, BlockNumber, Diagnostic, Diagnostics, Loaded, Severity, Source, amount};

pub use job::{Job, Step, ViseOpening, Workstation};
pub use origins::Origins;
pub use store::Store;

impl Store {
    /// Load all files `*.blk` under a data directory.
    ///
    /// # Errors
    /// The report, if it holds an error; every error of the data is in it.
    pub fn load(directory: &Path) -> Result<(Self, Diagnostics), Box<Diagnostics>> {
        Self::load_part(directory).map_err(|(_, report)| report)
    }

    /// The same, but data with errors give their readable part, for checks of jobs.
    ///
    /// # Errors
    /// That part, and the report.
    pub fn load_part(directory: &Path) -> Result<(Self, Diagnostics), (Box<Part>, Box<Diagnostics>)> {
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
    /// An entry that says again what an entry of these data says (a pose of the same name, the same grip of
    /// the same object at the same location …) replaces it and keeps its record number; other entries are
    /// appended. Nothing is removed, but for the locations of an object, which its newer object location
    /// entries replace together. Numbers of paths, their points and their parameters, which have no
    /// name, are given anew, and so are those of object locations.
    ///
    /// All blocks of the texts are loaded, as by `load` at a terminal, unless the texts have a root directory
    /// block; a directory may also name blocks that these data have. The whole of the new generation is
    /// checked, not only the new part.
    ///
    /// # Errors
    /// The report, if it holds an error; then there is no new generation.
    pub fn with_blocks(&self, texts: Vec<Source>) -> Result<(Self, Diagnostics), Box<Diagnostics>> {
        self.loaded_with(texts, Problems::default()).map_err(|(_, report)| report)
    }

    /// The next generation; errors are those of files that could not be read.
    fn loaded_with(
        &self,
        texts: Vec<Source>,
        problems: Problems,
    ) -> Result<(Self, Diagnostics), (Box<Part>, Box<Diagnostics>)> {
        let mut linked = self.linked(texts, problems);
        if !linked.problems.has_errors() {
            check::reach(&linked.store.view(), &linked.store.origins, &mut linked.problems);
        }
        linked.reported(self.sources.len())
    }

    /// The same as [`Store::with_blocks`], but the targets are not tried against the arm.
    ///
    /// # Errors
    /// The report, if it holds an error; then there is no new generation.
    pub fn with_blocks_untried(&self, texts: Vec<Source>) -> Result<(Self, Diagnostics), Box<Diagnostics>> {
        let linked = self.linked(texts, Problems::default());
        linked.reported(self.sources.len()).map_err(|(_, report)| report)
    }

    /// Read, link and check all but the reach.
    fn linked(&self, texts: Vec<Source>, mut problems: Problems) -> Linked {
        let incomplete = problems.has_errors();
        let first = self.sources.len();
        let mut sources = self.sources.clone();
        sources.extend(texts);
        let mut read = directory::read(&sources, first, &self.blocks, &mut problems);
        read.orphans.incomplete |= incomplete;
        let entries = self.entries.with(read.entries);
        let (files, indexes, origins, unknown) =
            link::link(&entries, &read.broken, &mut read.orphans, &mut problems);
        let unread = read.orphans.words().cloned().chain(read.broken).chain(unknown).collect();
        read.orphans.report(&mut problems);
        let commands = self.commands.with(read.commands);
        let count = read.blocks.len();
        let blocks = self.blocks.union(&read.blocks).copied().collect();
        let store = Self { files, indexes, sources, entries, blocks, origins, commands };
        // Records that name nothing are no use in checks of several entries; the names come first.
        let whole = !problems.has_errors();
        check::check(&store.view(), &store.origins, whole, &mut problems);
        if whole {
            store.commands.check(&store, &mut problems);
        }
        Linked { store, problems, blocks: count, unread }
    }
}

/// Result of the texts of a load.
struct Linked {
    store: Store,
    problems: Problems,
    /// Blocks that were read.
    blocks: usize,
    unread: HashSet<String>,
}

impl Linked {
    /// The store and its report, or what there is of it if the report holds an error; `before` texts were there before.
    fn reported(self, before: usize) -> Result<(Store, Diagnostics), (Box<Part>, Box<Diagnostics>)> {
        let Self { store, problems, blocks, unread } = self;
        let failed = problems.has_errors();
        let loaded = if failed { Vec::new() } else { store.loaded() };
        let mut report = Diagnostics::new(problems, store.places(), blocks, loaded);
        report.files = store.sources.len() - before;
        if failed { Err((Box::new(Part { store, unread }), Box::new(report))) } else { Ok((store, report)) }
    }
}

/// The readable part of task data with errors. No run uses it.
#[derive(Clone, Debug)]
pub struct Part {
    store: Store,
    /// Words of entries that could not be read or are not loaded, and unknown names.
    unread: HashSet<String>,
}

impl Part {
    /// True if a name that is not known, with the nearest one that is, is probably misspelt. Any other name may be in
    /// an entry that could not be read.
    fn is_slip(&self, name: &str, near: Option<&str>) -> bool {
        near.is_some() && !self.unread.iter().any(|word| word.starts_with(name))
    }
}
