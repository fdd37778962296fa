//! Files of the data directory that have a name on the command line: jobs, fault plans, robots.

use std::{
    error::Error,
    fmt, fs,
    path::{Path, PathBuf},
};

use os_io::files;

use crate::names::alternatives;

/// The jobs, `jobs/NAME.job`.
pub const JOBS: NamedFiles = NamedFiles { what: "job", directory: "jobs", extension: "job" };
/// The fault plans, `faults/NAME.toml`.
pub const FAULTS: NamedFiles = NamedFiles { what: "fault file", directory: "faults", extension: "toml" };
/// The robots, `robots/NAME.toml`.
pub const ROBOTS: NamedFiles = NamedFiles { what: "robot", directory: "robots", extension: "toml" };
/// The mappings of field I/O, `field/NAME.toml`.
pub const FIELDS: NamedFiles = NamedFiles { what: "mapping", directory: "field", extension: "toml" };

/// A kind of file of the data directory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NamedFiles {
    /// The kind, for messages.
    pub what: &'static str,
    /// The directory of the files, in the data directory.
    pub directory: &'static str,
    /// The extension of the files.
    pub extension: &'static str,
}

impl NamedFiles {
    /// The file of that name in the data directory, else the file with that path. Fails with [`UnknownFile`].
    pub fn find(&self, name: &Path, data: &Path) -> Result<PathBuf, UnknownFile> {
        let named = self.named(name, data);
        // A file that is not regular is accepted here, because the reader reports its kind.
        let is_path = named.is_err() && (files::is_file(name) || fs::symlink_metadata(name).is_ok());
        if is_path { Ok(name.to_owned()) } else { named }
    }

    /// The file of a name in the data directory. Fails with [`UnknownFile`] if there is none.
    pub fn named(&self, name: &Path, data: &Path) -> Result<PathBuf, UnknownFile> {
        let named = data.join(self.directory).join(name).with_added_extension(self.extension);
        if files::is_file(&named) {
            return Ok(named);
        }
        Err(UnknownFile { what: self.what, name: name.display().to_string(), known: self.names(data) })
    }

    /// All files of this kind in a data directory, sorted; empty if it has none.
    #[must_use]
    pub fn all(&self, data: &Path) -> Vec<PathBuf> {
        let mut all = files::list(&data.join(self.directory)).unwrap_or_default();
        all.retain(|path| path.extension().is_some_and(|extension| extension == self.extension));
        all
    }

    /// The names of all files of this kind in a data directory, sorted.
    #[must_use]
    pub fn names(&self, data: &Path) -> Vec<String> {
        let all = self.all(data);
        all.iter()
            .filter_map(|path| path.file_stem())
            .map(|name| name.to_string_lossy().into_owned())
            .collect()
    }
}

/// There is no file of this name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownFile {
    /// The kind of file.
    pub what: &'static str,
    /// The requested name or path.
    pub name: String,
    /// The names in the data directory.
    pub known: Vec<String>,
}

impl fmt::Display for UnknownFile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, name, known } = self;
        // The last part of a path can also be a name.
        let wanted = Path::new(name).file_stem().map_or_else(|| name.into(), |stem| stem.to_string_lossy());
        let known = known.iter().map(String::as_str);
        write!(f, "there is no {what} {name}: {}", alternatives(&wanted, known, "the data directory has"))
    }
}

impl Error for UnknownFile {}

#[cfg(test)]
mod tests {
    use super::*;

    fn data() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data")
    }

    #[test]
    fn file_is_found_by_name_or_path() {
        let named = data().join("faults/air-lost.toml");
        assert_eq!(FAULTS.find(Path::new("air-lost"), &data()), Ok(named.clone()));
        assert_eq!(FAULTS.find(&named, Path::new("/nowhere")), Ok(named));
        assert_eq!(ROBOTS.names(&data()), ["irb6700", "same"]);
    }

    #[test]
    fn unknown_file_has_the_nearest_name() {
        let why = |kind: NamedFiles, name: &str| kind.find(Path::new(name), &data()).unwrap_err().to_string();
        assert_eq!(why(JOBS, "lnkbar"), "there is no job lnkbar: the nearest is linkbar");
        let path = "faults/air-lots.toml";
        assert_eq!(why(FAULTS, path), format!("there is no fault file {path}: the nearest is air-lost"));
        assert_eq!(why(ROBOTS, "x"), "there is no robot x: the data directory has irb6700, same");
    }
}
