//! The file of a log: one run writes it, and detects changes by other programs.

use std::{
    fs::{self, File, TryLockError},
    io,
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
};

use os_io::files;

use crate::error::RecordError;

/// A file that only this run writes, until it is dropped. If it was made for a log that never began, it is removed
/// then.
pub struct LogFile {
    path: PathBuf,
    file: File,
    /// Device and inode.
    identity: (u64, u64),
    /// The file is new, and the log has not begun.
    unused: bool,
}

impl LogFile {
    /// Claim a file; create it, with its directory, if missing. Its content stays until the log begins.
    ///
    /// # Errors
    /// [`RecordError::InUse`] if another run writes it, [`RecordError::Create`] if it cannot be opened.
    pub fn claim(path: &Path) -> Result<Self, RecordError> {
        let failed = |source| RecordError::Create { path: path.to_owned(), source };
        if let Some(directory) = path.parent().filter(|directory| !directory.as_os_str().is_empty()) {
            fs::create_dir_all(directory).map_err(failed)?;
        }
        loop {
            let unused = fs::symlink_metadata(path).is_err();
            let file = files::create(path).map_err(failed)?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(RecordError::InUse { path: path.to_owned() }),
                Err(TryLockError::Error(source)) => return Err(failed(source)),
            }
            let found = file.metadata().map_err(failed)?;
            let claimed = Self { path: path.to_owned(), file, identity: (found.dev(), found.ino()), unused };
            // Another run may have removed the file, which it had not used, before it was locked here.
            if claimed.look().is_ok() {
                return Ok(claimed);
            }
        }
    }

    /// Claim `<name>.mcap` in a directory, or `<name>-2.mcap` and so on while other runs write those before it.
    ///
    /// # Errors
    /// [`RecordError::Create`].
    pub fn claim_free(directory: &Path, name: &str) -> Result<Self, RecordError> {
        let mut number = 1_u32;
        loop {
            let name = if number == 1 { name.to_owned() } else { format!("{name}-{number}") };
            match Self::claim(&directory.join(name).with_added_extension("mcap")) {
                Err(RecordError::InUse { .. }) => number += 1,
                claimed => return claimed,
            }
        }
    }

    /// Its path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file, empty: the log begins.
    pub(crate) fn emptied(&mut self) -> io::Result<File> {
        self.unused = false;
        self.file.set_len(0)?;
        self.file.try_clone()
    }

    /// Check that the file is still at its path.
    ///
    /// # Errors
    /// [`RecordError::Removed`].
    pub(crate) fn look(&self) -> Result<(), RecordError> {
        match fs::metadata(&self.path) {
            Ok(found) if (found.dev(), found.ino()) == self.identity => Ok(()),
            _ => Err(RecordError::Removed { path: self.path.clone() }),
        }
    }
}

impl Drop for LogFile {
    fn drop(&mut self) {
        if self.unused && self.look().is_ok() {
            // One that cannot be removed stays, empty.
            let _ = fs::remove_file(&self.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_whose_log_never_began_is_removed_if_it_was_made_for_it() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("run.mcap");
        drop(LogFile::claim(&path).unwrap());
        assert!(!path.exists());
        let mut begun = LogFile::claim(&path).unwrap();
        begun.emptied().unwrap();
        drop(begun);
        assert!(path.exists());
        fs::write(&path, "of a run before").unwrap();
        drop(LogFile::claim(&path).unwrap());
        assert_eq!(fs::read_to_string(&path).unwrap(), "of a run before");
    }

    #[test]
    fn a_second_run_gets_a_name_of_its_own_and_an_explicit_name_is_refused() {
        let directory = tempfile::tempdir().unwrap();
        let first = LogFile::claim_free(directory.path(), "linkbar").unwrap();
        assert_eq!(first.path(), directory.path().join("linkbar.mcap"));
        assert!(matches!(LogFile::claim(first.path()), Err(RecordError::InUse { .. })));
        let second = LogFile::claim_free(directory.path(), "linkbar").unwrap();
        assert_eq!(second.path(), directory.path().join("linkbar-2.mcap"));
        drop(first);
        assert_eq!(
            LogFile::claim_free(directory.path(), "linkbar").unwrap().path(),
            directory.path().join("linkbar.mcap")
        );
    }
}
