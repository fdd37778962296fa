//! LOAD while the run goes on (IV.2.4): a block of the run's own data directory, as it stands there now, becomes part of
//! the task data before the next command. The whole of the data is checked with it first.
//!
//! The log keeps the text, so that a replay, and the same inputs given again, load what was loaded then.

use std::fmt;

use executive::generations;
use taskdata::load::{
    BlockNumber, Source,
    source::{blocks, read_blocks_under},
};

use crate::{Run, boards::Controller, change::ChangeError};

/// Why a block is not loaded.
#[derive(Debug)]
pub enum LoadError {
    /// Boards of other processes have read their data before the first tick.
    Boards,
    /// The link to a robot would be silent while the data are checked.
    Robot,
    /// A command is executed.
    Busy,
    /// The data directory has no such block.
    NoBlock(BlockNumber),
    /// The log whose inputs are given again has not the text.
    NotRecorded,
    /// The data have errors with it.
    Change(ChangeError),
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Boards => f.write_str(
                "boards of other processes read their blocks before the first tick: a line `** load` of the job \
                 reaches them, or --boards one",
            ),
            Self::Robot => f.write_str(
                "the data are checked between two ticks, and the link to the robot would be silent meanwhile: load \
                 with the simulated robot, or begin a new run",
            ),
            Self::Busy => f.write_str("a command is executed, and keeps its records: PAUSE, or wait for its end"),
            Self::NoBlock(block) => write!(f, "the run's data directory has no {block}"),
            Self::NotRecorded => f.write_str("the log has no text of the block"),
            Self::Change(error) => error.fmt(f),
        }
    }
}

impl Run {
    /// Load a block before the next tick. Says what has come of it.
    ///
    /// # Errors
    /// [`LoadError`]; then nothing has changed.
    pub(crate) fn load_block(&mut self, number: BlockNumber) -> Result<String, LoadError> {
        if matches!(self.runner.levels(), Controller::Split(_)) {
            return Err(LoadError::Boards);
        }
        if self.robot.is_elsewhere() {
            return Err(LoadError::Robot);
        }
        if generations::is_busy(self.runner.memory()) {
            return Err(LoadError::Busy);
        }
        let generation = self.generations.number().saturating_add(1);
        let source = match self.asked.recorded_block(generation) {
            Some(recorded) => recorded.ok_or(LoadError::NotRecorded)?,
            None => {
                let (sources, _) = read_blocks_under(&self.config.data);
                sources.iter().find_map(|file| cut(file, number)).ok_or(LoadError::NoBlock(number))?
            }
        };
        let said = format!("{number} of {} is loaded; the data have generation {generation}", source.name);
        self.change_data(source).map_err(LoadError::Change)?;
        Ok(said)
    }
}

/// One block of a file, under the name of the file.
fn cut(file: &Source, number: BlockNumber) -> Option<Source> {
    let (found, _) = blocks(0, file);
    let at = found.iter().position(|block| block.number == number)?;
    let start = |at: usize| found.get(at).and_then(|block| usize::try_from(block.header.start).ok());
    let end = start(at + 1).unwrap_or(file.text.len());
    let text = file.text.get(start(at)?..end)?;
    Some(Source { name: file.name.clone(), text: text.into() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_is_cut_out_of_its_file() {
        let text = "%% about the file\nBLOCK# 1 OFFSET 21000\n  a\nBLOCK# 2 OFFSET 21000\n  b\n";
        let file = Source { name: "x.blk".into(), text: text.into() };
        let block = |number| cut(&file, BlockNumber { offset: 21_000, number });
        assert_eq!(block(1).unwrap().text.as_ref(), "BLOCK# 1 OFFSET 21000\n  a\n");
        assert_eq!(block(2).unwrap().text.as_ref(), "BLOCK# 2 OFFSET 21000\n  b\n");
        assert!(block(3).is_none() && block(2).unwrap().name == "x.blk");
    }
}
