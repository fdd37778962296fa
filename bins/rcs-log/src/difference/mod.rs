//! What is different between two runs: the one engine of `diff`, `fork` and `compare`.
//!
//! A [`Trace`] has what is compared of a run, from its log or from the run itself. [`Changes`] says which rows decided
//! otherwise, where the robot was commanded elsewhere, what took another time; [`Ends`], how else the runs ended.

mod changes;
mod ends;
mod trace;

use std::fmt;

use serde::Serialize;

pub use self::{
    changes::Changes,
    ends::{End, Ends},
    trace::Trace,
};

/// Which ticks belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Align {
    /// Ticks of the same number
    Tick,
    /// Ticks at the same distance from the beginning of the same command
    Command,
}

/// What is different between two whole runs.
#[derive(Debug, Serialize)]
pub struct Difference {
    /// How they ended.
    pub ends: Ends,
    /// What they did on the way.
    pub changes: Changes,
}

impl Difference {
    /// Compare two runs.
    #[must_use]
    pub fn between(a: &Trace, b: &Trace, align: Align) -> Self {
        Self { ends: Ends::between(&a.end, &b.end), changes: Changes::between(a, b, align) }
    }

    /// Nothing is different.
    #[must_use]
    pub const fn is_none(&self) -> bool {
        self.ends.is_empty() && self.changes.is_empty()
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.ends, self.changes)
    }
}
