//! `rcs-log report`: a run on one self-contained HTML page: the explained failure, commands by level over time, speed
//! with the limits of the link, forces, link faults, times of the controller, pictures of the cell at the start of
//! commands, paths from above and from the side, and the warnings and errors of the log.

mod gather;
mod page;
mod scene;
mod svg;

use std::{path::PathBuf, process::ExitCode};

use os_io::{
    console,
    replace::{Format, check_output, replace},
};

use crate::{Error, story::open};

/// Arguments of `report`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// The log
    pub file: PathBuf,
    /// Where to write the page [default: the log's name with .html]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Writes the page of a log.
pub fn report(arguments: &Arguments) -> Result<ExitCode, Error> {
    let output = arguments.output.clone().unwrap_or_else(|| arguments.file.with_extension("html"));
    let unwritten = |source| Error::Write { path: output.clone(), source };
    check_output(&output, Format::Html, [arguments.file.as_path()]).map_err(unwritten)?;
    let log = open(&arguments.file)?;
    let run = gather::gather(&log, &arguments.file)?;
    replace(&output, page::page(&log, &run).as_bytes()).map_err(unwritten)?;
    console::answer(&format!("{}\n", output.display()))?;
    Ok(ExitCode::SUCCESS)
}
