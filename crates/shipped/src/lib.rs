//! The data that comes with the programs: forms, jobs, cell description, faults, robots.

#![forbid(unsafe_code)]

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

/// The value of `--data` if none is given: `data` in the working directory, or [`BUILT_IN`] if there is nothing of that
/// name.
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

/// What a path of the command line means: the path itself if something is there; else the file or directory of that
/// name that is carried; else the path itself.
#[must_use]
pub fn resolve(path: PathBuf) -> PathBuf {
    let inside = Path::new(&format!("{PREFIX}{}", path.display())).to_path_buf();
    let is_there = fs::symlink_metadata(&path).is_ok();
    if !is_there && (files::is_file(&inside) || files::is_directory(&inside)) { inside } else { path }
}

/// Write all files into a directory, which is made if it is not there. Returns how many were written.
///
/// # Errors
/// [`io::ErrorKind::AlreadyExists`] with the path if a file of that name is there, before anything is written; else what
/// the system says.
pub fn write(directory: &Path) -> io::Result<usize> {
    let place = |file: &Carried| directory.join(file.path);
    if let Some(there) = FILES.iter().map(place).find(|path| fs::symlink_metadata(path).is_ok()) {
        let why = format!("{} is there already: name another directory", there.display());
        return Err(io::Error::new(io::ErrorKind::AlreadyExists, why));
    }
    for file in FILES {
        let path = place(file);
        path.parent().map_or(Ok(()), fs::create_dir_all)?;
        replace(&path, file.bytes)?;
    }
    Ok(FILES.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_copy_is_the_data_of_the_repository() {
        let place = tempfile::tempdir().unwrap();
        let count = write(place.path()).unwrap();
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
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
        assert!(error.to_string().contains("data/jobs/linkbar.job is there already"), "{error}");
        assert!(!place.path().join("data/cell.toml").exists());
    }

    #[test]
    fn a_file_of_the_person_goes_before_a_carried_one() {
        carry();
        let place = tempfile::tempdir().unwrap();
        let mine = place.path().join("cell.toml");
        fs::write(&mine, "").unwrap();
        assert_eq!(resolve(mine.clone()), mine);
        // Tests run in the directory of their crate, which has no data.
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
