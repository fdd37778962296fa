//! The camera on the wrist and its picture analysis (V.2.1 LOCATE-OBJ, VII.7.6).
//!
//! The picture is taken when vision gets its request (a line-flash and a flood-flash box): [`optics`] gives the field
//! of view, and for each part the cell gives the visible points ([`subject`]): the raster points of its upper face that
//! are in the field of view and not hidden. From these the [`analysis`] gives its answer some ticks later; it uses
//! nothing else, and can run in another process.

pub mod analysis;
pub mod optics;
pub mod subject;

pub use analysis::Analysis;
pub use optics::Optics;
pub use subject::{Face, Subject};
