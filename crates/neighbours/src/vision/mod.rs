//! The NBS vision system and E-move (IX.4, V.2.1 LOCATE-OBJ).
//!
//! Vision has a parallel interface of its own, which to the software looks like a slightly modified mailbox:
//! a request area and a response area, the byte-count of each, and two words that say which of them may be
//! used. Figure IX.3, with addresses and sizes, is lost. CHOSEN: two mailboxes, one each way, so that each
//! has one writer; their data are the areas.
//!
//! ```text
//!   E-move --VisionRequest--> Port --request---> F8000 --> vision
//!   E-move <-VisionResponse-- Port <-areas------ F8200 <-- vision
//!                             Port --picture---> F8400 --> vision, for the simulated cell only
//! ```
//!
//! Both ready words are vision's: `vision-ready-input` is 2 while the response area is at rest and may be
//! read, `vision-ready-output` is 2 while a request may be written. The controller sets them once, by
//! initialization (blocks 984-986): input "ready", since there is nothing in the response area that could be
//! half written, and output "not ready", since no vision system is there yet. Vision establishes
//! communications when it writes its mailbox the first time.
//!
//! [`Port`] stands where E-move's READ-VISION-DATA and WRITE-VISION-REQUEST stood (IV.4.4). E-move knows
//! nothing of it: what it reads is part of its device inputs, and with them in the log.

pub mod areas;
pub mod picture;
mod port;
pub mod request;

pub use areas::{Areas, Ready};
pub use picture::Picture;
pub use port::{Port, Remark};

use crate::{fields::FieldError, layout::LayoutError};

/// Why bytes are no request, no areas or no picture.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum VisionError {
    /// Size or fields of a fixed layout cannot be.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// More parts than the mailbox holds.
    #[error("at most {most} parts were expected in a picture, found {found}")]
    Parts {
        /// As many as it holds.
        most: usize,
        /// Their count.
        found: usize,
    },
    /// A part of a picture.
    #[error("part {part}: {source}")]
    Part {
        /// Which part, from 1.
        part: usize,
        /// What is wrong with it.
        source: LayoutError,
    },
    /// A field that cannot be read.
    #[error(transparent)]
    Field(#[from] FieldError),
}
