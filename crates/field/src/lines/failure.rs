//! Why a line has failed, as a value and as a sentence.

use std::fmt;

/// Why a line has failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    pub line: String,
    pub why: Why,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Why {
    /// The mapping has no entry for the line.
    NoEntry,
    /// This other line is still executed.
    Occupied(String),
    /// A condition of `needs` does not hold.
    Needs(Observed),
    /// An input of `fault` is on.
    Fault(Observed),
    /// A condition of `while` is lost.
    Lost(Observed),
    /// This condition of `begun` did not hold in time, s.
    NotBegun(Observed, u16),
    /// This condition of `done` did not hold in time, s.
    NotDone(Observed, u16),
    /// This device was tripped before the line had begun, so it is unknown whether the line has begun.
    Unknown(String),
    /// This device was tripped after the line had begun.
    Interrupted(String),
    /// This device is tripped; the line can begin again.
    Tripped(String),
}

/// A point and its value when a line failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Observed {
    pub point: String,
    /// `None`: not read in time.
    pub found: Option<i64>,
    pub expected: i64,
}

impl fmt::Display for Observed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { point, found, expected } = self;
        match found {
            Some(found) => write!(f, "{point} is {found}, {expected} was expected"),
            None => write!(f, "{point} was not read, {expected} was expected"),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { line, why } = self;
        match why {
            Why::NoEntry => write!(f, "`{line}` has no [[line]] in the mapping, and its devices are real"),
            Why::Occupied(other) => write!(f, "`{line}` cannot begin: `{other}` is still executed"),
            Why::Needs(what) => write!(f, "`{line}` cannot begin: {what}"),
            Why::Fault(what) => {
                write!(f, "`{line}`: the device reports a fault: {} is {}", what.point, what.expected)
            }
            Why::Lost(what) => write!(f, "`{line}` is no longer safe: {what}"),
            Why::NotBegun(what, s) => write!(f, "`{line}` has not begun within {s} s: {what}"),
            Why::NotDone(what, s) => write!(f, "`{line}` has not ended within {s} s: {what}"),
            Why::Unknown(device) => write!(
                f,
                "`{line}`: {device} is tripped, and it is unknown whether the line has begun: look; `job skip` if it \
                 has ended, `job go` starts it again"
            ),
            Why::Tripped(device) => {
                write!(
                    f,
                    "`{line}`: {device} is tripped; after `io go {device}`, `job go` begins the line again"
                )
            }
            Why::Interrupted(device) => write!(
                f,
                "`{line}`: {device} is tripped; after `io go {device}`, `job go` waits for the end without a second \
                 start"
            ),
        }
    }
}

impl std::error::Error for Failure {}
