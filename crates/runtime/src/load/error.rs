use std::{fmt, io, time::Duration};

use executive::boards::Board;
use taskdata::load::{BlockNumber, Diagnostics};

/// Time limit for the boards' check of a load.
pub const LOAD_LIMIT: Duration = Duration::from_secs(10);

#[derive(Debug)]
pub enum LoadError {
    Busy,
    Loading,
    /// The operator has left or disconnected before the boards had checked the block.
    Withdrawn,
    NoBlock(BlockNumber),
    Outside(String),
    /// The log whose inputs are replayed does not contain the text.
    NotRecorded,
    Recorded(String),
    Data(Box<Diagnostics>),
    /// The job has meanwhile loaded blocks, or waits for the end of a command to load some.
    Reload,
    Write(io::Error),
    Late,
    Differs(Board),
    NoThread,
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Busy => {
                f.write_str("a command is executed, and keeps its records: PAUSE, or wait for its end")
            }
            Self::Loading => f.write_str("another block is being checked: ask again when that is answered"),
            Self::Withdrawn => f.write_str(
                "the operator who asked for it has left before it was checked; nothing has changed",
            ),
            Self::NoBlock(block) => write!(f, "the run's data directory has no {block}"),
            Self::Outside(file) => write!(
                f,
                "{file} is a link to a file outside of the run's data directory: a block of that directory was expected"
            ),
            Self::NotRecorded => f.write_str("the log has no text of the block"),
            Self::Recorded(why) => f.write_str(why),
            Self::Data(report) => write!(f, "with this change the task data have errors:\n{report}"),
            Self::Reload => f.write_str("the job loads blocks at this moment: ask again"),
            Self::Write(error) => write!(f, "the blocks for the boards cannot be written: {error}"),
            Self::Late => write!(
                f,
                "not all boards have checked it within {} s; nothing has changed",
                LOAD_LIMIT.as_secs()
            ),
            Self::Differs(board) => {
                write!(
                    f,
                    "{board} has other task data after this: it was started with other data; nothing has changed"
                )
            }
            Self::NoThread => f.write_str("the thread that checks blocks has ended; nothing has changed"),
        }
    }
}

impl LoadError {
    #[must_use]
    pub fn in_line(&self) -> String {
        match self {
            Self::Data(report) => format!("with this change the task data have errors: {}", report.in_line()),
            other => other.to_string(),
        }
    }
}
