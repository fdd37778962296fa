//! Files that are built into a program, so that it runs in any directory. A path that begins with [`PREFIX`] names
//! such a file, for example `shipped:data/cell.toml`; [`files`](crate::files) reads it like any other.

use std::{
    collections::BTreeSet,
    io::{self, ErrorKind},
    path::{Path, PathBuf},
    sync::OnceLock,
};

/// Prefix of the path of a built-in file.
pub const PREFIX: &str = "shipped:";

/// A file that is built into the program.
#[derive(Clone, Copy, Debug)]
pub struct Carried {
    /// Path of the file, without the prefix.
    pub path: &'static str,
    /// Contents of the file.
    pub bytes: &'static [u8],
}

static CARRIED: OnceLock<&'static [Carried]> = OnceLock::new();

/// Makes `files` readable under [`PREFIX`] in the whole process. Later calls have no effect.
pub fn carry(files: &'static [Carried]) {
    let _ = CARRIED.set(files);
}

/// True for the path of a built-in file or directory.
#[must_use]
pub fn is_carried(path: &Path) -> bool {
    inside(path).is_some()
}

/// `None` for a path of the file system.
pub(crate) fn inside(path: &Path) -> Option<&str> {
    path.to_str()?.strip_prefix(PREFIX)
}

pub(crate) fn read(path: &str) -> io::Result<&'static [u8]> {
    let found = all().iter().find(|file| file.path == path).map(|file| file.bytes);
    found.ok_or_else(|| {
        let why = format!("no such file is built into this program: {path}");
        io::Error::new(ErrorKind::NotFound, why)
    })
}

/// The entries of a directory, with the prefix; empty if there are none.
pub(crate) fn list(directory: &str) -> Vec<PathBuf> {
    let below = |file: &Carried| Path::new(file.path).strip_prefix(directory).ok();
    let first = |rest: &'static Path| rest.components().next();
    let names: BTreeSet<_> = all().iter().filter_map(below).filter_map(first).collect();
    names.iter().map(|name| Path::new(&format!("{PREFIX}{directory}")).join(name)).collect()
}

fn all() -> &'static [Carried] {
    CARRIED.get().copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files;

    #[test]
    fn carried_files_are_read_as_others() {
        carry(&[
            Carried { path: "data/a.txt", bytes: b"one\r" },
            Carried { path: "data/jobs/b.txt", bytes: b"two" },
        ]);
        let path = |text: &str| PathBuf::from(text);
        assert_eq!(files::read_text(&path("shipped:data").join("a.txt")).unwrap(), "one\n");
        assert_eq!(files::read(&path("shipped:data/a.txt"), 3).unwrap_err().kind(), ErrorKind::FileTooLarge);
        assert_eq!(files::read_text(&path("shipped:data/c")).unwrap_err().kind(), ErrorKind::NotFound);
        assert_eq!(files::read_text(&path("shipped:data")).unwrap_err().kind(), ErrorKind::NotFound);
        assert!(
            files::is_directory(&path("shipped:data")) && files::is_directory(&path("shipped:data/jobs"))
        );
        assert!(
            !files::is_directory(&path("shipped:dat")) && !files::is_directory(&path("shipped:data/a.txt"))
        );
        assert!(files::is_file(&path("shipped:data/jobs/b.txt")) && !files::is_file(&path("shipped:data")));
        let listed = files::list(&path("shipped:data")).unwrap();
        assert_eq!(listed, [path("shipped:data/a.txt"), path("shipped:data/jobs")]);
        assert_eq!(files::list(&path("shipped:none")).unwrap_err().kind(), ErrorKind::NotFound);
    }
}
