//! Task data (chapter VII): what the robot knows of poses, locations, trajectories and objects.
//!
//! People write *forms*; a form becomes records of *files* (POSE, MOVTAB, LOCPT …), and the control processes look the
//! records up by number or by name while they run (II.2.4). The two halves of this crate are that border:
//!
//! * [`files`]: the records, and [`files::TaskData`], slices of them and their indexes. No heap, no standard library, no look-up
//!   that takes longer for more records. This is all that the control processes see.
//! * `load` (feature `load`): reads the blocks of a data directory, checks every form against all others and
//!   against the arm, reports all errors at once, and builds the files and their indexes.

#![cfg_attr(not(any(test, feature = "load")), no_std)]
#![forbid(unsafe_code)]
#![warn(missing_docs)]
#![cfg_attr(
    not(test),
    deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic)
)]

pub mod files;
#[cfg(feature = "load")]
pub mod load;
