//! Names in the file: of its metadata, topics and keys, and words with which lines begin.

/// Name of the metadata written at the start.
pub const RUN: &str = "rcs-run";
/// Name of the metadata written at the end.
pub const END: &str = "rcs-end";
/// Key of the layout version in [`RUN`].
pub const LAYOUT: &str = "layout";
/// Topic of the byte images.
pub const REPLAY: &str = "/replay";
pub const LOG_TOPIC: &str = "/log";
/// Begin of the line on `/log` that names the log before this one.
pub(crate) const EARLIER: &str = "the ticks before this one are in ";
/// Begin of the result of a log after which the run began another one.
pub(crate) const CONTINUES: &str = "the run continues at tick ";
/// Key of the metadata: how the run ended.
pub(crate) const RESULT: &str = "result";
