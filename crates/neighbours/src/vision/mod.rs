//! The NBS vision system and E-move (IX.4, V.2.1 LOCATE-OBJ).
//!
//! Vision has its own parallel interface, which the software uses like a slightly modified mailbox: a request area and
//! a response area, the byte-count of each, and two words that permit their use. Figure IX.3, with addresses and sizes,
//! is lost. CHOSEN: two mailboxes, one per direction, so that each has one writer; their data are the areas.
//!
//! ```text
//!   E-move --VisionRequest--> Port --request---> F8000 --> vision
//!   E-move <-VisionResponse-- Port <-areas------ F8200 <-- vision
//!                             Port --picture---> F8400 --> vision, for the simulated cell only
//! ```
//!
//! Vision writes both ready words: `vision-ready-input` is 2 while the response area is stable and may be read,
//! `vision-ready-output` is 2 while a request may be written. The controller sets them only by initialization
//! (blocks 984-986): input "ready", because the response area is empty, and output "not ready", because no
//! vision system is connected. Vision establishes communications when it writes its mailbox for the first time.
//!
//! The crate `sessions` has the controller's end: its `vision::Port` implements E-move's READ-VISION-DATA and
//! WRITE-VISION-REQUEST (IV.4.4). E-move is independent of it: it reads the response as part of its device
//! inputs, which are logged.

pub mod areas;
pub mod picture;
pub mod request;

pub use areas::{Areas, Ready};
pub use picture::Picture;

use crate::{fields::FieldError, layout::LayoutError};

/// Why bytes are not a request, areas or a picture.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum VisionError {
    /// Wrong size or field of a fixed layout.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// More parts than the mailbox holds.
    #[error("at most {most} parts were expected in a picture, found {found}")]
    Parts {
        /// Number of parts that the mailbox holds.
        most: usize,
        /// Number of parts in the picture.
        found: usize,
    },
    /// Wrong size or field of a part.
    #[error("part {part}: {source}")]
    Part {
        /// Number of the part, from 1.
        part: usize,
        source: LayoutError,
    },
    /// A field that cannot be read.
    #[error(transparent)]
    Field(#[from] FieldError),
}
