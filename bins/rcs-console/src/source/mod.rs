//! Sources of pictures: a run in progress, or a log.

mod deltas;
mod live;
mod recorded;
mod seen;

pub use live::Live;
pub use recorded::Recorded;

use executive::memory::{cell::CellView, field::FieldView};
use record::views::{Commander, Controller, JobState, Part};
use runtime::controller_state;
use taskdata::load::Source as Blocks;

use crate::rcs_console::{picture::Picture, story::Story};

/// A source of pictures. It never writes to the data that it reads.
pub trait Source {
    fn about(&self) -> About<'_>;

    fn refresh(&mut self);

    /// First and last available tick; `None` before the first.
    fn range(&self) -> Option<(u64, u64)>;

    /// The picture of the last tick up to `tick`.
    fn picture(&self, tick: u64) -> Option<Picture>;

    fn story(&self) -> &Story;

    fn cell(&self, tick: u64) -> Cell;

    /// The couplers and points in the tick of a picture; `None` without field I/O.
    fn field(&self, _: &Picture) -> Option<Box<FieldView>> {
        None
    }

    fn cell_text(&self) -> Option<&str> {
        None
    }

    fn blocks(&self) -> Option<&[Blocks]> {
        None
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct About<'a> {
    pub name: &'a str,
    pub state: State,            // log, or state of the run
    pub result: Option<&'a str>, // ending of the run, one line, once known
    pub damage: Option<String>,  // the parts of a log that cannot be read, as text
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum State {
    Log,
    Runs,
    Over,        // the run has ended in an orderly way
    Silent(u64), // no new tick for this number of seconds
    Torn,        // the last attempts found buffers that were being written or could not be read
}

/// State of the cell in a source, in addition to the controller's sensors.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    NotPublished,         // not published: the robot is at a port
    Shown(Box<CellView>), // the published state of a simulated cell
    Recorded(Box<RecordedCell>),
}

/// State of the cell in a log. The log of an older program has only the positions of the parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedCell {
    pub job: Option<JobState>,
    pub commander: Option<Commander>,
    /// The simulated robot controller; `None` also with a robot at a port.
    pub controller: Option<Controller>,
    pub parts: Vec<(Part, [f64; 3])>, // each part in the cell, with its position, in
    /// Closest clearance and contacts of the whole run; `None` before its end, or if the log has none.
    pub clearance: Option<String>,
    pub contacts: Option<String>,
}

impl Cell {
    #[must_use]
    pub fn job(&self) -> Option<JobState> {
        match self {
            Self::NotPublished => None,
            Self::Shown(view) => Some(JobState {
                phase: view.job.phase.to_string().into(),
                index: view.job.begun,
                lines: view.job.lines,
                text: view.job.line.to_string(),
                began: view.job.began.0,
                reason: view.job.reason.to_string(),
                ..JobState::default()
            }),
            Self::Recorded(cell) => cell.job.clone(),
        }
    }

    /// Who commands, as a clause's subject; `None` if the source does not have it.
    #[must_use]
    pub fn commander(&self) -> Option<String> {
        let Commander { source, operator, .. } = match self {
            Self::NotPublished => return None,
            Self::Shown(view) => Commander {
                source: view.commander.source.to_string().into(),
                operator: view.commander.operator.to_string(),
                ..Commander::default()
            },
            Self::Recorded(cell) => cell.commander.clone()?,
        };
        match (&*source, operator) {
            ("", _) => None,
            ("job" | "operator", operator) if !operator.is_empty() => Some(operator),
            (source, _) => Some(format!("the {source}")),
        }
    }

    #[must_use]
    pub fn controller(&self) -> Option<Controller> {
        match self {
            Self::NotPublished => None,
            Self::Shown(view) => Some(controller_state(&view.controller)),
            Self::Recorded(cell) => cell.controller.clone(),
        }
    }
}
