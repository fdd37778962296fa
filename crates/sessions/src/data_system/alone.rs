//! The exclusive right of one program to write to a database. SQLite itself locks only for a statement.

use std::{
    fs::{self, File, OpenOptions, TryLockError},
    io,
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
};

const SUFFIX: &str = "lock"; // suffix of the file that is locked, after the name of the database

/// The exclusive right to use a database, held until it is dropped. The system releases it whenever the program ends.
#[derive(Debug)]
pub struct DatabaseLock {
    path: PathBuf,
    _lock: File,
}

impl DatabaseLock {
    /// Takes the right for an existing file; `None` if another program holds it.
    pub fn take(database: &Path) -> io::Result<Option<Self>> {
        // All links to the database share one file.
        let path = fs::canonicalize(database)?.with_added_extension(SUFFIX);
        loop {
            let file = OpenOptions::new().create(true).append(true).open(&path)?;
            match file.try_lock() {
                // The previous program may meanwhile have removed the file.
                Ok(()) if is_at(&file, &path)? => return Ok(Some(Self { path, _lock: file })),
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Ok(None),
                Err(TryLockError::Error(error)) => return Err(error),
            }
        }
    }
}

impl Drop for DatabaseLock {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
    }
}

fn is_at(file: &File, path: &Path) -> io::Result<bool> {
    match fs::metadata(path) {
        Ok(found) => Ok(found.ino() == file.metadata()?.ino()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}
