//! Names in the file: of its metadata, topics and keys, and beginnings of lines.

pub const RUN: &str = "rcs-run";
pub const END: &str = "rcs-end";
/// Key of the layout version in [`RUN`].
pub const LAYOUT: &str = "layout";
pub const REPLAY: &str = "/replay";
pub const LOG_TOPIC: &str = "/log";
/// Beginning of the line on `/log` that names the previous log.
pub(crate) const EARLIER: &str = "the ticks before this one are in ";
/// Beginning of the result of a log that the run continues in another one.
pub(crate) const CONTINUES: &str = "the run continues at tick ";
pub(crate) const RESULT: &str = "result";
