//! The camera on the wrist and its picture analysis (V.2.1 LOCATE-OBJ, VII.7.6).
//!
//! The picture is taken when vision gets its request (a line-flash and a flood-flash box): [`optics`] says where the camera looks,
//! and of each part the cell says what of it the camera sees ([`subject`]): the raster points of its upper face that lie in the
//! field of view and before which nothing stands. From these the [`analysis`] has its answer some ticks later; it knows nothing
//! else, and can live in another process.

pub mod analysis;
pub mod optics;
pub mod subject;

pub use analysis::Analysis;
pub use optics::Optics;
pub use subject::{Face, Subject};
