//! The web page that shows a run: its sources, and how they become one file.
//!
//! The sources are plain HTML, CSS and JavaScript modules in `web/`. They are embedded in the programs, so that every
//! program that shows a run serves or writes the same page. Browsers do not load modules from `file://`, so
//! [`document`] writes style, modules and log into one HTML file ([`inline`]).
//!
//! Not every browser can decompress zstd. [`pack`] copies a log with deflate, which all browsers have, sorted by
//! channel, and without the channels that the page does not show. The decision tables, and the reasons with their
//! remedies, are those of the log.

mod inline;
mod pack;

pub use inline::{Content, bundle, document};
pub use pack::{pack, pack_start};
