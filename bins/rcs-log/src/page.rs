//! `rcs-log page` and `open`: write a log as one page for a browser, which needs no other file and no network.
//!
//! `open` writes the page next to the log: other users of the machine could read a served page.

use std::{path::PathBuf, process::ExitCode};

use os_io::{
    browser, console,
    replace::{Format, check_output, replace},
    stderr_line,
};
use record::{
    Log,
    explanation::{self, REASONS, TABLES, reasons, tables},
    input::Attachment,
};
use serde::Serialize;
use serde_json::Value;

use crate::{Error, info, story, why};

/// Arguments of `page` and `open`.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// The log
    pub file: PathBuf,
    /// Where to write the page [default: the log's name with .html]
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

pub fn page(arguments: &Arguments) -> Result<ExitCode, Error> {
    let output = write(arguments)?;
    console::answer(&format!("{}\n", output.display()))?;
    Ok(ExitCode::SUCCESS)
}

pub fn open(arguments: &Arguments) -> Result<ExitCode, Error> {
    let output = write(arguments)?;
    console::answer(&format!("{}\n", output.display()))?;
    // An absolute path cannot be read as an option, even if the name of the log begins with a dash.
    let path = std::path::absolute(&output).unwrap_or(output);
    if let Err(error) = browser::open(path.as_os_str()) {
        stderr_line!("rcs-log: no browser can be started: {error}; open {} in one", path.display());
    }
    Ok(ExitCode::SUCCESS)
}

fn write(arguments: &Arguments) -> Result<PathBuf, Error> {
    let output = arguments.output.clone().unwrap_or_else(|| arguments.file.with_extension("html"));
    let unwritten = |source| Error::Write { path: output.clone(), source };
    check_output(&output, Format::Html, [arguments.file.as_path()]).map_err(unwritten)?;
    let log = story::open(&arguments.file)?;
    let answers = [
        json("info.json", &info::summary(&log, &arguments.file)?)?,
        json("why.json", &why::explanation(&log, &arguments.file, None)?)?,
        json("tables.json", &of_log(&log, TABLES, tables))?,
        json("reasons.json", &of_log(&log, REASONS, reasons))?,
    ];
    let name = arguments.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let document = page::document(&name, page::Content::Log(&page::pack(&log, &answers)));
    replace(&output, document.as_bytes()).map_err(unwritten)?;
    Ok(output)
}

/// Tables or reasons of a log. If the log has none, the tables or reasons of this program.
fn of_log(log: &Log, name: &str, own: impl FnOnce() -> Value) -> Value {
    explanation::of_log(log, name).unwrap_or_else(|| {
        os_io::stderr_line!(
            "rcs-log: the log of an older program has no {name}: the page shows the tables or remedies of this program"
        );
        own()
    })
}

fn json<T: Serialize>(name: &str, answer: &T) -> Result<Attachment, Error> {
    let data = serde_json::to_vec(answer).map_err(std::io::Error::from)?;
    Ok(Attachment { name: name.into(), media_type: "application/json".into(), data })
}
