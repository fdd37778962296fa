//! The camera on the wrist and its picture analysis (V.2.1 LOCATE-OBJ, VII.7.6).
//!
//! [`optics`] gives the field of view; [`subject`] the visible points of each part. From these points alone,
//! [`analysis`] computes the answer, which is due some ticks later; it can run in another process.

pub mod analysis;
pub mod optics;
pub mod subject;

pub use analysis::Analysis;
pub use optics::Optics;
pub use subject::{Face, Subject};
