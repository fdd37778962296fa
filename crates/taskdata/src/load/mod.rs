//! Reading, checking and linking task data (feature `load`).
//!
//! Every stage continues after an error, so one load reports all errors:
//!
//! 1. [`source`]: files into blocks; [`lex`]: blocks into words;
//! 2. [`parse`], [`forms`] and [`guarded`]: words into [`entries`];
//! 3. [`directory`]: selects the blocks to load (Figure VIII.12);
//! 4. `link`: names into record numbers, duplicates, unknown names;
//! 5. `check`: errors that would stop a command, and targets out of reach;
//! 6. [`store`]: the files; [`origins`]: where each record was entered; [`Diagnostics`]: all findings.
//!
//! [`mod@print`] writes entries as forms; [`job`] reads job files; [`commands`] reads blocks of commands for Task;
//! [`verdict`] checks a command against the task data.

pub mod alike;
mod check;
mod collected;
pub mod commands;
pub mod directory;
pub mod entries;
pub mod fault;
pub mod forms;
pub mod guarded;
mod index;
pub mod job;
pub mod lex;
mod link;
pub mod origins;
mod orphans;
pub mod parallel;
pub mod parse;
pub mod parser;
pub mod print;
pub mod show;
pub mod source;
pub mod store;
pub mod verdict;

use std::{collections::HashSet, path::Path};

use diagnostics::Problems;
pub use diagnostics::{At, BlockNumber, Diagnostic, Diagnostics, Loaded, Severity, Source};

pub use fault::Fault;
pub use job::{Job, Step, Workstation};
pub use origins::Origins;
pub use store::Store;

impl Store {
    /// Loads all files `*.blk` under a data directory. Errors: the report with every error of the data.
    pub fn load(directory: &Path) -> Result<(Self, Diagnostics), Box<Diagnostics>> {
        Self::load_part(directory).map_err(|(_, report)| report)
    }

    /// Like [`Store::load`]. Errors: the readable part, for checks of jobs, and the report.
    pub fn load_part(directory: &Path) -> Result<(Self, Diagnostics), (Box<Part>, Box<Diagnostics>)> {
        let (sources, unreadable) = source::read_blocks_under(directory);
        let mut problems = Problems::default();
        unreadable.iter().for_each(|(path, error)| problems.unreadable(path, error));
        Self::default().loaded_with(sources, problems)
    }

    /// Loads data with errors, too. [`Store::faults_of`] lists the errors that concern a command.
    #[must_use]
    pub fn load_with_faults(directory: &Path) -> (Self, Diagnostics) {
        Self::load_part(directory).unwrap_or_else(|(part, report)| (part.store, *report))
    }

    /// Like [`Store::load_with_faults`], for texts from another source.
    #[must_use]
    pub fn from_sources_with_faults(sources: Vec<Source>) -> (Self, Diagnostics) {
        let loaded = Self::default().loaded_with(sources, Problems::default());
        loaded.unwrap_or_else(|(part, report)| (part.store, *report))
    }

    /// Loads texts from another source, such as the attachments of a log. Errors: the report.
    pub fn from_sources(sources: Vec<Source>) -> Result<(Self, Diagnostics), Box<Diagnostics>> {
        Self::default().with_blocks(sources)
    }

    /// The next generation of the data (docs/design/ownership.md "Reload"); `self` does not change. An entry with the
    /// key of an existing one replaces it and keeps its record number; others are appended. Nothing is removed, except
    /// the locations of an object, which newer object location entries replace. Paths, points, parameters and object
    /// locations get new numbers.
    ///
    /// All blocks of the texts are loaded, unless the texts have a root directory block, which may also name existing
    /// blocks. The whole new generation is checked. An error that is not in the present data prevents the load.
    pub fn with_blocks(&self, texts: Vec<Source>) -> Result<(Self, Diagnostics), Box<Diagnostics>> {
        let (part, report) = match self.loaded_with(texts, Problems::default()) {
            Ok(loaded) => return Ok(loaded),
            Err(failed) => failed,
        };
        let first = u32::try_from(self.sources.len()).unwrap_or(u32::MAX);
        let is_new = |error: &Diagnostic| error.at().is_none_or(|at| at.source >= first);
        let is_known = |fault: &Fault| self.faults.iter().any(|known| known.is_same(fault));
        if !report.errors().any(is_new) && part.store.faults.iter().all(is_known) {
            Ok((part.store, *report))
        } else {
            Err(report)
        }
    }

    /// `problems` has the errors of unreadable files.
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

    /// Like [`Store::with_blocks`], without the check of the reach.
    pub fn with_blocks_untried(&self, texts: Vec<Source>) -> Result<(Self, Diagnostics), Box<Diagnostics>> {
        let linked = self.linked(texts, Problems::default());
        linked.reported(self.sources.len()).map_err(|(_, report)| report)
    }

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
        let (faults, found) = (Vec::new(), self.found.clone());
        let store = Self { files, indexes, sources, entries, blocks, origins, commands, faults, found };
        // Checks of several entries need known names, so errors of names are reported first.
        let whole = !problems.has_errors();
        check::check(&store.view(), &store.origins, whole, &mut problems);
        if whole {
            store.commands.check(&store, &mut problems);
        }
        Linked { store, problems, blocks: count, unread }
    }
}

struct Linked {
    store: Store,
    problems: Problems,
    blocks: usize, // that were read
    unread: HashSet<String>,
}

impl Linked {
    /// The store and report, or the readable part if there is an error. `before`: number of earlier texts.
    fn reported(self, before: usize) -> Result<(Store, Diagnostics), (Box<Part>, Box<Diagnostics>)> {
        let Self { mut store, problems, blocks, unread } = self;
        let failed = problems.has_errors();
        let loaded = if failed { Vec::new() } else { store.loaded() };
        let mut report = Diagnostics::new(problems, store.places(), blocks, loaded);
        report.files = store.sources.len() - before;
        store.faults = report.errors().map(|error| Fault::found(error, &store)).collect();
        if failed { Err((Box::new(Part { store, unread }), Box::new(report))) } else { Ok((store, report)) }
    }
}

#[derive(Clone, Debug)]
pub struct Part {
    store: Store,
    unread: HashSet<String>, // words of entries that are unreadable or not loaded, and unknown names
}

impl Part {
    /// True if `name` is probably a misspelling of `near`, the nearest known name, and not in an unreadable entry.
    fn is_slip(&self, name: &str, near: Option<&str>) -> bool {
        near.is_some() && !self.unread.iter().any(|word| word.starts_with(name))
    }
}
