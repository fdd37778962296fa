//! `rcs-run init`: writes an editable copy of the data that are built into the program.

use std::process::ExitCode;

use os_io::text::amount;
use os_io::{console, shell};

use crate::rcs_run::{arguments::InitArguments, error::Error};

/// Write the copy. Fails with [`Error::Write`] if a file exists already, or cannot be written.
pub fn init(arguments: &InitArguments) -> Result<ExitCode, Error> {
    let directory = &arguments.directory;
    let count = crate::shipped::write(directory)
        .map_err(|source| Error::Write { path: directory.clone(), source })?;
    let is_here = directory.as_os_str() == ".";
    let data = if is_here { "data".into() } else { directory.join("data") };
    let data = shell::path(data);
    let option = if is_here { String::new() } else { format!(" --data {data}") };
    console::answer(&format!(
        "{} written into {data}; check them with rcs-run check{option}\n",
        amount(count, "file")
    ))?;
    Ok(ExitCode::SUCCESS)
}
