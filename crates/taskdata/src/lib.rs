//! Task data (chapter VII): poses, locations, trajectories and objects.
//!
//! Programmers write *forms*; a form becomes records of *files* (POSE, MOVTAB, LOCPT …), and the control processes look
//! the records up by number or by name while they run (II.2.4). This crate has two halves:
//!
//! * [`files`]: the records, and [`files::TaskData`]: slices of the records, and their indexes. It uses neither
//!   heap nor standard library, and the time of a look-up does not grow with the number of records. The control
//!   processes use only this half.
//! * `load` (feature `load`): reads the blocks of a data directory, checks every form against all others and
//!   against the arm, reports all errors at once, and builds the files and their indexes.

#![cfg_attr(not(any(test, feature = "load")), no_std)]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)
)]

pub mod files;
#[cfg(feature = "load")]
pub mod load;
