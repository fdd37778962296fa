//! Sources of pictures: a run in progress, or a log.

mod deltas;
mod live;
mod recorded;
mod seen;

pub use live::Live;
pub use recorded::Recorded;

use executive::memory::cell::CellView;
use taskdata::load::Source as Blocks;

use crate::rcs_console::{picture::Picture, story::Story};

/// A source of pictures. It never writes to the data that it reads.
pub trait Source {
    /// Name and state of the source.
    fn about(&self) -> About<'_>;

    fn refresh(&mut self);

    /// First and last available tick; `None` before the first.
    fn range(&self) -> Option<(u64, u64)>;

    /// The picture of the last tick up to `tick`.
    fn picture(&self, tick: u64) -> Option<Picture>;

    /// The changes from tick to tick.
    fn story(&self) -> &Story;

    fn cell(&self, tick: u64) -> Cell;

    /// The description of the cell, if the source contains it.
    fn cell_text(&self) -> Option<&str> {
        None
    }

    /// The blocks of the task data, if the source contains them.
    fn blocks(&self) -> Option<&[Blocks]> {
        None
    }
}

/// Name and state of a source.
#[derive(Clone, Debug, PartialEq)]
pub struct About<'a> {
    /// Name of the run, or of the log file.
    pub name: &'a str,
    /// Log, or state of the run.
    pub state: State,
    /// Ending of the run, one line, once known.
    pub result: Option<&'a str>,
    /// The parts of a log that cannot be read, as text.
    pub damage: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum State {
    Log,
    Runs,
    /// The run has ended in an orderly way.
    Over,
    /// No new tick for this number of seconds.
    Silent(u64),
    /// The last attempts found buffers that were being written or could not be read.
    Torn,
}

/// State of the cell in a source, in addition to the controller's sensors.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Not published: the robot is at a port.
    NotPublished,
    /// The published state of a simulated cell.
    Shown(Box<CellView>),
    Recorded {
        /// Name and position in inches of each part that has moved or been delivered.
        parts: Vec<(String, [f64; 3])>,
        /// Closest clearance and contacts of the whole run; `None` before its end, or if the log has none.
        clearance: Option<String>,
        contacts: Option<String>,
    },
}
