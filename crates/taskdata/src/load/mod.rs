//! Reading, checking and linking task data (feature `load`).
//!
//! The stages are one module each, and every stage goes on after an error, so that one load shows all that is wrong:
//!
//! 1. [`source`]: files into blocks; [`lex`]: blocks into words;
//! 2. [`parse`], [`forms`] and [`guarded`]: words into [`entries`];
//! 3. [`directory`]: which blocks are loaded at all (Figure VIII.12);
//! 4. `link`: names into record numbers, duplicates, unknown names;
//! 5. `check`: geometry: every place the robot is sent to can be reached;
//! 6. [`store`]: the files; [`report`]: everything that was found.
//!
//! [`job`] reads the job files, which stand beside the blocks.

mod check;
pub mod directory;
pub mod entries;
pub mod forms;
pub mod guarded;
pub mod job;
pub mod lex;
mod link;
pub mod names;
pub mod parse;
pub mod report;
pub mod source;
pub mod store;

use std::path::Path;

pub use job::{Job, Step, ViseOpening, Workstation};
pub use report::{Diagnostic, Loaded, Report, Severity};
pub use source::{BlockNumber, Source};
pub use store::Store;

use report::Problems;

impl Store {
    /// Load all files `*.blk` under a data directory.
    ///
    /// # Errors
    /// The report, if it holds an error; every error of the data is in it.
    pub fn load(directory: &Path) -> Result<(Self, Report), Box<Report>> {
        match source::read_blocks_under(directory) {
            Ok(sources) => Self::from_sources(sources),
            Err((path, error)) => {
                let mut problems = Problems::default();
                problems.unreadable(&path, &error);
                Err(Box::new(Report::new(problems, &[], 0, Vec::new())))
            }
        }
    }

    /// Load texts that were read elsewhere, such as the attachments of a log.
    ///
    /// # Errors
    /// The report, if it holds an error; every error of the data is in it.
    pub fn from_sources(sources: Vec<Source>) -> Result<(Self, Report), Box<Report>> {
        let mut problems = Problems::default();
        let read = directory::read(&sources, &mut problems);
        let (files, indexes, origins) = link::link(read.entries, read.broken, &sources, &mut problems);
        let store = Self { files, indexes, sources };
        // Frames that could not be linked are no use in checking reach; the names come first.
        if !problems.has_errors() {
            check::check(&store.view(), &origins, &mut problems);
        }
        let failed = problems.has_errors();
        let loaded = if failed { Vec::new() } else { store.loaded() };
        let report = Report::new(problems, &store.sources, read.blocks, loaded);
        if failed { Err(Box::new(report)) } else { Ok((store, report)) }
    }
}
