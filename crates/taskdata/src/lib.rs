//! Task data (chapter VII): poses, locations, trajectories and objects.
//!
//! Programmers write *forms*; a form becomes records of *files* (POSE, MOVTAB, LOCPT …), which the control processes
//! look up by number or by name (II.2.4). This crate has two halves:
//!
//! * [`files`]: records, and [`files::TaskData`]: slices of them with their indexes, for the control processes. No
//!   heap, no standard library; the time of a look-up does not grow with the number of records.
//! * `load` (feature `load`): reads the blocks of a data directory, checks every form against all others and the arm,
//!   reports all errors at once, and builds files and indexes.

#![cfg_attr(not(any(test, feature = "load")), no_std)]
#![forbid(unsafe_code)]
#![cfg_attr(
    not(test),
    deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)
)]

pub mod files;
#[cfg(feature = "load")]
pub mod load;
