//! Why a line has failed, as a value and as a sentence.

use std::fmt;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    pub line: String,
    pub why: Why,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Why {
    NoEntry,                 // the mapping has no entry for the line
    Occupied(String),        // this other line is still executed
    Needs(Observed),         // a condition of `needs` does not hold
    Fault(Observed),         // an input of `fault` is on
    Lost(Observed),          // a condition of `while` is lost
    NotBegun(Observed, u16), // this condition of `begun` did not hold in time, s
    NotDone(Observed, u16),  // this condition of `done` did not hold in time, s
    /// This device was tripped before the line had begun, so it is unknown whether the line has begun.
    Unknown(String),
    Interrupted(String), // this device was tripped after the line had begun
    Tripped(String),     // this device is tripped; the line can begin again
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Observed {
    pub point: String,
    pub found: Option<i64>, // `None`: not read in time
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
