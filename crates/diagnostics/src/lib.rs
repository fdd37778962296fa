//! Diagnostics of text files: all problems of a file, each with its place, expected and found value, and nearest name.
//!
//! A reader adds each problem to [`Problems`] and continues. [`Diagnostics::new`] finds the places with [`Places`] and
//! makes a report: a text with the places underlined, or a list of [`Finding`] for programs. A [`Problem`] names a
//! piece of text ([`At`]) or an entry of TOML (`gripper.parts.body[0]`), whose place [`toml::Document`] finds.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod diagnostic;
mod finding;
mod groups;
mod named_files;
mod names;
mod places;
mod problem;
mod report;
mod same;
mod source;
pub mod toml;

pub use diagnostic::Diagnostic;
pub use finding::Finding;
pub use groups::{DataGroup, Group, grouped};
pub use named_files::{FAULTS, FIELDS, JOBS, NamedFiles, ROBOTS, UnknownFile};
pub use names::{alternatives, distance, nearest};
pub use places::{Places, Position};
pub use problem::{Problem, Problems, Severity};
pub use report::{Diagnostics, Loaded};
pub use source::{At, BlockLines, BlockNumber, Source, lines_of};
