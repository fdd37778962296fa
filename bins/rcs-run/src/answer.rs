//! Answers on standard output: as text, or as JSON.

use std::{fmt, io};

use os_io::console;
use serde::Serialize;

use crate::rcs_run::error::Error;

/// Print an answer: as one line of JSON, or as text.
pub fn answer<T: Serialize + fmt::Display>(answer: &T, json: bool) -> Result<(), Error> {
    if json {
        let text = serde_json::to_string(answer).map_err(io::Error::from)?;
        return Ok(console::json(&(text + "\n"))?);
    }
    Ok(console::answer(&answer.to_string())?)
}

/// Print a long answer as JSON on several lines.
pub fn answer_long_json(answer: &impl Serialize) -> Result<(), Error> {
    let text = serde_json::to_string_pretty(answer).map_err(io::Error::from)?;
    Ok(console::json(&(text + "\n"))?)
}
