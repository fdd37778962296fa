//! Where pictures come from: a run that goes on, or a log.

mod deltas;
mod live;
mod recorded;

pub use live::Live;
pub use recorded::Recorded;

use executive::memory::cell::CellView;
use taskdata::load::Source as Blocks;

use crate::{picture::Picture, story::Story};

/// A source of pictures. None of them ever writes to what it reads.
pub trait Source {
    /// What is looked at.
    fn about(&self) -> About<'_>;

    /// Take in what is new.
    fn refresh(&mut self);

    /// First and last tick that can be shown; none before there is one.
    fn range(&self) -> Option<(u64, u64)>;

    /// The last picture that is not later than a tick.
    fn picture(&self, tick: u64) -> Option<Picture>;

    /// What happened from tick to tick.
    fn story(&self) -> &Story;

    /// The cell as it was in a tick.
    fn cell(&self, tick: u64) -> Cell;

    /// The description of the cell, if the source holds it.
    fn cell_text(&self) -> Option<&str> {
        None
    }

    /// The blocks of the task data, if the source holds them.
    fn blocks(&self) -> Option<&[Blocks]> {
        None
    }
}

/// What is looked at.
#[derive(Clone, Debug, PartialEq)]
pub struct About<'a> {
    /// Name of the run, or of the log file.
    pub name: &'a str,
    /// It is a log, or a run in some state.
    pub state: State,
    /// How the run ended, one line; none while it is not known.
    pub result: Option<&'a str>,
    /// What of a log cannot be read, in words.
    pub damage: Option<String>,
}

/// A log, or what is known of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum State {
    /// A log.
    Log,
    /// The run goes on.
    Runs,
    /// The run has ended, and has said so.
    Over,
    /// No new tick has come for so many seconds.
    Silent(u64),
    /// Its buffers were being written, or could not be read, at the last attempts.
    Torn,
}

/// What a source tells of the cell, beside what the controller senses.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Nothing: the robot is at a port.
    NotPublished,
    /// What a simulated cell shows.
    Shown(Box<CellView>),
    /// What a log has.
    Recorded {
        /// Name and position in inches of each part that has moved or been delivered.
        parts: Vec<(String, [f64; 3])>,
        /// Closest clearance and contacts of the whole run; none before its end, or if nothing is said of them.
        clearance: Option<String>,
        /// Contacts of the whole run that are not permitted.
        contacts: Option<String>,
    },
}
