use std::{
    fmt,
    path::{self, Path, PathBuf},
};

use os_io::text::amount;
use os_io::{carried::is_carried, shell};
use serde::Serialize;

/// The task data and the cell description of a run.
#[derive(Clone, Debug, Serialize)]
pub struct DataResult {
    /// Their directory, an absolute path; `None` if they are built into the program.
    pub directory: Option<PathBuf>,
    /// Number of files that were read.
    pub files: usize,
}

impl DataResult {
    #[must_use]
    pub fn new(directory: &Path, files: usize) -> Self {
        let absolute = || path::absolute(directory).unwrap_or_else(|_| directory.to_owned());
        Self { directory: (!is_carried(directory)).then(absolute), files }
    }
}

impl fmt::Display for DataResult {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let files = amount(self.files, "file");
        match &self.directory {
            Some(directory) => write!(f, "{}, {files}", shell::path(directory)),
            None => write!(f, "built into the program, {files}"),
        }
    }
}
