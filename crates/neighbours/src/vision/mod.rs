//! The NBS vision system and E-move (IX.4, V.2.1 LOCATE-OBJ).
//!
//! Vision has a parallel interface, used like a slightly modified mailbox. It has a request and a response area, their
//! byte-counts, and two words that permit their use. Figure IX.3, with addresses and sizes, is lost. CHOSEN: two
//! mailboxes, one per direction, so that each has one writer.
//!
//! ```text
//!   E-move --VisionRequest--> Port --request---> F8000 --> vision
//!   E-move <-VisionResponse-- Port <-areas------ F8200 <-- vision
//!                             Port --picture---> F8400 --> vision, for the simulated cell only
//! ```
//!
//! Vision writes both ready words: `vision-ready-input` is 2 while the response area may be read,
//! `vision-ready-output` while a request may be written. The controller only initializes them (blocks 984-986). Input
//! is "ready", because the response is empty. Output is "not ready", because no vision system is connected. Vision
//! establishes communications when it first writes its mailbox. The crate `sessions` has the controller's end, E-move's
//! READ-VISION-DATA and WRITE-VISION-REQUEST (IV.4.4): `vision::Port`. E-move reads the response as a logged device
//! input.

pub mod areas;
pub mod picture;
pub mod request;

pub use areas::{Areas, Ready};
pub use picture::Picture;

use crate::{fields::FieldError, layout::LayoutError};

#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum VisionError {
    #[error(transparent)]
    Layout(#[from] LayoutError), // size or field
    #[error("at most {most} parts were expected in a picture, found {found}")]
    Parts {
        most: usize,  // in the mailbox
        found: usize, // in the picture
    },
    #[error("part {part}: {source}")]
    Part {
        part: usize, // from 1
        source: LayoutError,
    },
    #[error(transparent)]
    Field(#[from] FieldError),
}
