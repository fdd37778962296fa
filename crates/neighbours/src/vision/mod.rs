//! The NBS vision system and E-move (IX.4, V.2.1 LOCATE-OBJ).
//!
//! Vision has a parallel interface of its own, which to the software looks like a slightly modified mailbox: a request area and a
//! response area, the byte-count of each, and two words that say which of them may be used. Figure IX.3, with addresses and sizes,
//! is lost. CHOSEN: two mailboxes, one each way, so that each has one writer; their data are the areas.
//!
//! ```text
//!   E-move --VisionRequest--> Port --request---> F8000 --> vision
//!   E-move <-VisionResponse-- Port <-areas------ F8200 <-- vision
//!                             Port --picture---> F8400 --> vision, for the simulated cell only
//! ```
//!
//! Both ready words are vision's: `vision-ready-input` is 2 while the response area is at rest and may be read,
//! `vision-ready-output` is 2 while a request may be written. The controller sets them once, by initialization (blocks 984-986): input
//! "ready", since there is nothing in the response area that could be half written, and output "not ready", since nobody is there yet.
//! Vision establishes communications when it writes its mailbox the first time.
//!
//! [`Port`] stands where E-move's READ-VISION-DATA and WRITE-VISION-REQUEST stood (IV.4.4). E-move knows nothing of it: what it
//! reads is part of its device inputs, and with them in the log.

pub mod areas;
pub mod picture;
mod port;
pub mod request;

pub use areas::{Areas, Ready};
pub use picture::Picture;
pub use port::{Port, Remark};

use crate::fields::FieldError;

/// Why bytes are no request, no areas or no picture.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum VisionError {
    /// More or fewer bytes.
    #[error("{what} of {expected} bytes was expected, found {found}")]
    Length {
        /// What they should be.
        what: &'static str,
        /// Bytes of it.
        expected: usize,
        /// Bytes found.
        found: usize,
    },
    /// A byte-count that is not that of the area.
    #[error("{field} {expected} was expected, found {found}")]
    ByteCount {
        /// Which.
        field: &'static str,
        /// That of the area.
        expected: usize,
        /// The one found.
        found: u16,
    },
    /// A ready word that says neither.
    #[error("1 (not ready) or 2 (ready) was expected for {field}, found {found}")]
    Ready {
        /// Which.
        field: &'static str,
        /// The word.
        found: u16,
    },
    /// A number that is none.
    #[error("a finite number was expected for {field} of part {part}, found {found}")]
    Number {
        /// Which.
        field: &'static str,
        /// Of which part, from 1.
        part: usize,
        /// The number.
        found: f64,
    },
    /// A field that cannot be read.
    #[error(transparent)]
    Field(#[from] FieldError),
}
