//! `rcs-log page`: writes a log as one page for a browser, which needs no other file and no network.

use std::{path::PathBuf, process::ExitCode};

use os_io::{
    console,
    replace::{Format, check_output, replace},
};
use record::input::Attachment;
use serde::Serialize;

use crate::{Error, info, story::open, why};

/// Arguments of `page`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// The log
    pub file: PathBuf,
    /// Where to write the page [default: the log's name with .html]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// Writes the page of a log.
pub fn page(arguments: &Arguments) -> Result<ExitCode, Error> {
    let output = arguments.output.clone().unwrap_or_else(|| arguments.file.with_extension("html"));
    let unwritten = |source| Error::Write { path: output.clone(), source };
    check_output(&output, Format::Html, [arguments.file.as_path()]).map_err(unwritten)?;
    let log = open(&arguments.file)?;
    let answers = [
        json("info.json", &info::summary(&log, &arguments.file)?)?,
        json("why.json", &why::explanation(&log, &arguments.file, None)?)?,
        json("tables.json", &page::tables())?,
        json("reasons.json", &page::reasons())?,
    ];
    let name = arguments.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let document = page::document(&name, Some(&page::pack(&log, &answers)));
    replace(&output, document.as_bytes()).map_err(unwritten)?;
    console::answer(&format!("{}\n", output.display()))?;
    Ok(ExitCode::SUCCESS)
}

/// An answer of this program as a file in the page.
fn json<T: Serialize>(name: &str, answer: &T) -> Result<Attachment, Error> {
    let data = serde_json::to_vec(answer).map_err(std::io::Error::from)?;
    Ok(Attachment { name: name.into(), media_type: "application/json".into(), data })
}
