//! Why a file of faults cannot be used: where, what was expected, what was found.

use std::io;

use depc::fault::text::PlanFileError;
use strsim::damerau_levenshtein;

/// Why a file of faults cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum FaultFileError {
    /// The file cannot be read.
    #[error("{file}: cannot be read: {source}")]
    Read {
        /// The file.
        file: String,
        /// What the system says.
        source: io::Error,
    },
    /// It is no file of faults, or one of the line is wrong.
    #[error(transparent)]
    Line(#[from] PlanFileError),
    /// A fault of the cell makes no sense.
    #[error("{file}, line {line}, fault {number}: {problem}")]
    Fault {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Number of the fault, from 1.
        number: usize,
        /// What is wrong.
        problem: Problem,
    },
}

/// What is wrong with a fault.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// No such word in a list.
    #[error("there is no {what} {found:?}; {}", among(.known, .found))]
    Unknown {
        /// What it should be.
        what: &'static str,
        /// What stands there.
        found: String,
        /// All that there are.
        known: Vec<&'static str>,
    },
    /// No part of that name in the cell description.
    #[error("there is no part {found:?} in the cell description; it has {known}")]
    UnknownPart {
        /// What stands there.
        found: String,
        /// All names.
        known: String,
    },
    /// A key that the kind does not take.
    #[error("{kind} takes no `{key}`; it takes {}", .takes.join(", "))]
    Key {
        /// The kind.
        kind: &'static str,
        /// The key.
        key: String,
        /// What it takes.
        takes: Vec<&'static str>,
    },
    /// A key that the kind needs.
    #[error("{kind} needs {needs}")]
    Needs {
        /// The kind.
        kind: &'static str,
        /// What it needs.
        needs: &'static str,
    },
    /// A value out of its range.
    #[error("`{key}`: expected {expected}, found {found}")]
    Value {
        /// The key.
        key: &'static str,
        /// What was expected.
        expected: String,
        /// What was found.
        found: String,
    },
    /// The entry is of another type.
    #[error("{0}")]
    Type(String),
    /// Two beginnings.
    #[error("expected one of `at`, `from` and `after`, found more")]
    Beginnings,
    /// A window without a tick.
    #[error("expected `until` behind the beginning, found {from} to {until}: there is no tick in it")]
    EmptyWindow {
        /// Its first tick.
        from: u64,
        /// The tick behind it.
        until: u64,
    },
    /// A length beside a window.
    #[error(
        "a range of ticks without a rate says already how long it lasts: leave `ticks` out, or give a rate"
    )]
    TwoLengths,
    /// Too many tick marks.
    #[error("`at` is one moment: say with `ticks` how long it lasts, or use `from` and `until`")]
    AtAndUntil,
    /// The camera answers in messages.
    #[error("the camera is no converter: it can be off or intermittent, and there is the kind camera-blind")]
    Camera,
}

/// The nearest of some words, and all of them if they are not many.
fn among(known: &[&str], found: &str) -> String {
    let nearest = known.iter().min_by_key(|known| damerau_levenshtein(known, found));
    let all = || format!("there are {}", known.join(", "));
    match nearest {
        Some(nearest) if known.len() > 24 || damerau_levenshtein(nearest, found) <= 3 => {
            format!("did you mean {nearest:?}? {}", all())
        }
        _ => all(),
    }
}
