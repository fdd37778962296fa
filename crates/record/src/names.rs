//! Names in the file: of its metadata, topics and keys, and beginnings of lines.

/// Name of the metadata written at the start.
pub const RUN: &str = "rcs-run";
/// Name of the metadata written at the end.
pub const END: &str = "rcs-end";
/// Key of the layout version in [`RUN`].
pub const LAYOUT: &str = "layout";
/// Topic of the byte images.
pub const REPLAY: &str = "/replay";
pub const LOG_TOPIC: &str = "/log";
/// Beginning of the line on `/log` that names the previous log.
pub(crate) const EARLIER: &str = "the ticks before this one are in ";
/// Beginning of the result of a log that the run continues in another one.
pub(crate) const CONTINUES: &str = "the run continues at tick ";
/// Key of the metadata: the ending of the run.
pub(crate) const RESULT: &str = "result";
