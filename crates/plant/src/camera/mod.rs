//! The camera on the wrist and its picture analysis (V.2.1 LOCATE-OBJ, VII.7.6).
//!
//! The camera takes the picture when the vision system receives its request (a line-flash and a flood-flash
//! box). [`optics`] gives the field of view; for each part the cell gives the visible points ([`subject`]): the
//! raster points of its upper face that are in the field of view and not hidden. From these points alone,
//! [`analysis`] computes the answer, which is due some ticks later; it can run in another process.

pub mod analysis;
pub mod optics;
pub mod subject;

pub use analysis::Analysis;
pub use optics::Optics;
pub use subject::{Face, Subject};
