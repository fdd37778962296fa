//! Differences between two runs, for `diff`, `fork` and `compare`.
//!
//! A [`Trace`] holds the compared data of a run. [`Changes`] lists rows, motions and times; [`Ends`] the ends.

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

#[derive(Debug, Serialize)]
pub struct Difference {
    pub ends: Ends,
    pub changes: Changes,
}

impl Difference {
    #[must_use]
    pub fn between(a: &Trace, b: &Trace, align: Align) -> Self {
        Self { ends: Ends::between(&a.end, &b.end), changes: Changes::between(a, b, align) }
    }

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
