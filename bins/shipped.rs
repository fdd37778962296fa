//! The data that comes with the programs: forms, jobs, cell description, faults, robots.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use os_io::{
    carried::{self, Carried, PREFIX},
    files,
    replace::replace,
};

/// All files of `data/`.
pub static FILES: &[Carried] = include!(concat!(env!("OUT_DIR"), "/files.rs"));

/// The name of the built-in data on the command line.
pub const BUILT_IN: &str = "built-in";
/// The data directory if no other one is named.
const DATA: &str = "data";

/// The default of `--data`: `data` in the working directory, or [`BUILT_IN`] if no such directory exists.
#[must_use]
pub fn default_data() -> &'static str {
    if fs::symlink_metadata(DATA).is_ok() { DATA } else { BUILT_IN }
}

/// The data directory that a person names: [`BUILT_IN`], or an existing directory. `None` if there is no such directory.
#[must_use]
pub fn data_directory(named: &Path) -> Option<PathBuf> {
    let directory =
        if named == BUILT_IN { PathBuf::from(format!("{PREFIX}{DATA}")) } else { named.to_owned() };
    files::is_directory(&directory).then_some(directory)
}

/// Make the files readable under `shipped:data/`, for the whole process.
pub fn carry() {
    carried::carry(FILES);
}

/// The meaning of a path on the command line: an existing path, else the built-in file or directory of that name, else
/// the unchanged path.
#[must_use]
pub fn resolve(path: PathBuf) -> PathBuf {
    let inside = Path::new(&format!("{PREFIX}{}", path.display())).to_path_buf();
    let is_there = fs::symlink_metadata(&path).is_ok();
    if !is_there && (files::is_file(&inside) || files::is_directory(&inside)) { inside } else { path }
}

/// Write all files into a directory, and create it if missing. Returns the number of files.
///
/// # Errors
/// [`io::ErrorKind::AlreadyExists`] with the path if a file exists, before any file is written; otherwise the system's
/// error.
pub fn write(directory: &Path) -> io::Result<usize> {
    let place = |file: &Carried| directory.join(file.path);
    if let Some(there) = FILES.iter().map(place).find(|path| fs::symlink_metadata(path).is_ok()) {
        let why = format!("{} already exists: name another directory", there.display());
        return Err(io::Error::new(io::ErrorKind::AlreadyExists, why));
    }
    let mut made = Made::default();
    for file in FILES {
        if let Err(error) = made.write(&place(file), file.bytes) {
            made.remove();
            return Err(error);
        }
    }
    Ok(FILES.len())
}

/// The files and directories that were made, each after the directory that contains it.
#[derive(Default)]
struct Made(Vec<PathBuf>);

impl Made {
    fn write(&mut self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let is_missing = |directory: &&Path| !directory.as_os_str().is_empty() && !directory.exists();
        let mut missing: Vec<_> = path.ancestors().skip(1).take_while(is_missing).collect();
        missing.reverse();
        for directory in missing {
            fs::create_dir(directory)?;
            self.0.push(directory.to_owned());
        }
        replace(path, bytes)?;
        self.0.push(path.to_owned());
        Ok(())
    }

    /// Remove the created files and directories. Errors are ignored, because the caller reports the original error.
    fn remove(self) {
        for path in self.0.iter().rev() {
            let _ = fs::remove_file(path).or_else(|_| fs::remove_dir(path));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_copy_is_the_data_of_the_repository() {
        let place = tempfile::tempdir().unwrap();
        let count = write(place.path()).unwrap();
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        for file in FILES {
            assert_eq!(
                fs::read(place.path().join(file.path)).unwrap(),
                fs::read(root.join(file.path)).unwrap()
            );
        }
        let mut open = vec![root.join("data")];
        let mut on_disk = 0;
        while let Some(directory) = open.pop() {
            for path in files::list(&directory).unwrap() {
                if path.is_dir() { open.push(path) } else { on_disk += 1 }
            }
        }
        assert_eq!(count, on_disk);
    }

    #[test]
    fn nothing_is_overwritten() {
        let place = tempfile::tempdir().unwrap();
        fs::create_dir_all(place.path().join("data/jobs")).unwrap();
        fs::write(place.path().join("data/jobs/linkbar.job"), "mine").unwrap();
        let error = write(place.path()).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::AlreadyExists);
        assert!(error.to_string().contains("data/jobs/linkbar.job already exists"), "{error}");
        assert!(!place.path().join("data/cell.toml").exists());
    }

    #[test]
    fn a_failed_copy_leaves_no_file() {
        let place = tempfile::tempdir().unwrap();
        // This directory cannot be created, after many files were written.
        let blocked = "data/robots";
        assert!(FILES.iter().position(|file| file.path.starts_with(blocked)).unwrap() > 10);
        let target = place.path().join("new").join(blocked);
        fs::create_dir_all(target.parent().unwrap()).unwrap();
        std::os::unix::fs::symlink("nowhere/at all", &target).unwrap();
        assert!(write(&place.path().join("new")).is_err());
        let mut left = Vec::new();
        let mut open = vec![place.path().to_owned()];
        while let Some(directory) = open.pop() {
            for path in files::list(&directory).unwrap() {
                if path.is_dir() {
                    open.push(path.clone())
                }
                left.push(path);
            }
        }
        left.sort();
        assert_eq!(left, [place.path().join("new"), place.path().join("new/data"), target]);
    }

    #[test]
    fn a_file_of_the_person_goes_before_a_carried_one() {
        carry();
        let place = tempfile::tempdir().unwrap();
        let mine = place.path().join("cell.toml");
        fs::write(&mine, "").unwrap();
        assert_eq!(resolve(mine.clone()), mine);
        // Tests run in the directory of their crate, which has no `data`.
        assert_eq!(default_data(), BUILT_IN);
        assert_eq!(data_directory(Path::new(BUILT_IN)).as_deref(), Some(Path::new("shipped:data")));
        assert_eq!(data_directory(Path::new("data")), None, "a directory that is named must exist");
        assert_eq!(data_directory(place.path()).as_deref(), Some(place.path()));
        assert_eq!(
            resolve("data/faults/air-lost.toml".into()),
            Path::new("shipped:data/faults/air-lost.toml")
        );
        assert_eq!(resolve("data/faults/none.toml".into()), Path::new("data/faults/none.toml"));
    }
}
