//! Diagnostics of text files: all problems of a file at once, each with its place, what was expected, what was found,
//! and the nearest known name.
//!
//! A reader adds what it finds to [`Problems`] and reads on. [`Diagnostics::new`] ties the problems to the texts by
//! [`Places`] and makes a report of them: for a person, with the line underlined; for programs, as a list of
//! [`Finding`]. A [`Problem`] names either a piece of text ([`At`]) or an entry of TOML (`gripper.parts.body[0]`),
//! whose place [`toml::Document`] knows.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod diagnostic;
mod finding;
mod names;
mod places;
mod problem;
mod report;
mod same;
mod source;
pub mod toml;

pub use diagnostic::Diagnostic;
pub use finding::Finding;
pub use names::{distance, nearest};
pub use places::{Places, Position};
pub use problem::{Problem, Problems, Severity};
pub use report::{Diagnostics, Loaded, amount};
pub use source::{At, BlockLines, BlockNumber, Source, lines_of};
