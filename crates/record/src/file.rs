//! The file of a log: one run writes it, and detects changes by other programs.

use std::{
    fs::{self, File, TryLockError},
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
    time::SystemTime,
};

use os_io::{
    files,
    replace::{Format, check_output},
};
use time::OffsetDateTime;

use crate::error::RecordError;

/// A file that only this run writes. If no log began, dropping it removes a created file.
pub struct LogFile {
    path: PathBuf,
    file: File,
    identity: (u64, u64),
    unused: bool, // true if the file is new, and the log has not begun
    /// True if an earlier log at the path is renamed when this one begins, false if it is replaced.
    keeps_earlier: bool,
}

impl LogFile {
    /// Claim a file, created if necessary with its directory. Its content stays until the log begins. Fails with
    /// [`RecordError::InUse`] if another run writes it.
    pub fn claim(path: &Path) -> Result<Self, RecordError> {
        let failed = |source| RecordError::Create { path: path.to_owned(), source };
        if let Some(directory) = path.parent().filter(|directory| !directory.as_os_str().is_empty()) {
            fs::create_dir_all(directory).map_err(failed)?;
        }
        loop {
            let unused = fs::symlink_metadata(path).is_err();
            check_output(path, Format::Mcap, []).map_err(failed)?;
            let file = files::create(path).map_err(failed)?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(RecordError::InUse { path: path.to_owned() }),
                Err(TryLockError::Error(source)) => return Err(failed(source)),
            }
            let found = file.metadata().map_err(failed)?;
            let identity = (found.dev(), found.ino());
            let claimed = Self { path: path.to_owned(), file, identity, unused, keeps_earlier: false };
            // Another run may have removed the unused file before it was locked here.
            if claimed.look().is_ok() {
                return Ok(claimed);
            }
        }
    }

    /// Claim `<name>.mcap`, or `<name>-2.mcap` and so on while other runs write the earlier ones. A log of an earlier
    /// run is kept under the time of its end, for example `<name>-2026-11-27T214500Z.mcap`.
    pub fn claim_free(directory: &Path, name: &str) -> Result<Self, RecordError> {
        let mut number = 1_u32;
        loop {
            let name = if number == 1 { name.to_owned() } else { format!("{name}-{number}") };
            match Self::claim(&directory.join(name).with_added_extension("mcap")) {
                Err(RecordError::InUse { .. }) => number += 1,
                claimed => {
                    let mut file = claimed?;
                    file.keeps_earlier = true;
                    return Ok(file);
                }
            }
        }
    }

    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn length(&self) -> Result<u64, RecordError> {
        let found = self.file.metadata();
        found.map(|found| found.len()).map_err(|_| RecordError::Removed { path: self.path.clone() })
    }

    /// End this log, which stays open for its writer, and begin a new one at its path. Returns the new file, and the
    /// new name of the ended one.
    pub(crate) fn succeeded(&self) -> Result<(Self, PathBuf), RecordError> {
        let name = free_name(&self.path, SystemTime::now());
        let failed = |source| RecordError::Create { path: self.path.clone(), source };
        fs::rename(&self.path, &name).map_err(failed)?;
        Ok((Self::claim(&self.path)?, name))
    }

    /// The empty file for a log that begins. An earlier log is renamed if it must be kept.
    pub(crate) fn emptied(&mut self) -> Result<File, RecordError> {
        let failed = |path: &Path| {
            let path = path.to_owned();
            |source| RecordError::Create { path, source }
        };
        if self.keeps_earlier {
            let earlier = self.file.metadata().map_err(failed(&self.path))?;
            if earlier.len() > 0 {
                let ended = earlier.modified().map_err(failed(&self.path))?;
                fs::rename(&self.path, free_name(&self.path, ended)).map_err(failed(&self.path))?;
                *self = Self::claim(&self.path.clone())?;
            }
        }
        self.unused = false;
        self.file.set_len(0).and_then(|()| self.file.try_clone()).map_err(failed(&self.path))
    }

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
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// A name for an earlier log: the log's name with the time in UTC, and a number if that name exists.
fn free_name(path: &Path, ended: SystemTime) -> PathBuf {
    let at = OffsetDateTime::from(ended);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let stem = format!(
        "{stem}-{:04}-{:02}-{:02}T{:02}{:02}{:02}Z",
        at.year(),
        u8::from(at.month()),
        at.day(),
        at.hour(),
        at.minute(),
        at.second()
    );
    let numbers = (2_u32..).map(|number| format!("{stem}-{number}.mcap"));
    let mut names =
        std::iter::once(format!("{stem}.mcap")).chain(numbers).map(|name| path.with_file_name(name));
    names.find(|name| fs::symlink_metadata(name).is_err()).unwrap_or_else(|| path.to_owned())
}

/// True if [`free_name`] gives this name to earlier logs of a log.
pub fn is_earlier(log: &Path, path: &Path) -> bool {
    let stem = log.file_stem().unwrap_or_default().to_string_lossy();
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let Some(rest) = name.strip_prefix(&format!("{stem}-")).and_then(|rest| rest.strip_suffix(".mcap"))
    else {
        return false;
    };
    let (time, number) = rest.split_at_checked("2026-11-27T214500Z".len()).unwrap_or((rest, ""));
    let as_digit = |c: char| if c.is_ascii_digit() { '0' } else { c };
    let is_number = |number: &str| !number.is_empty() && number.chars().all(|c| c.is_ascii_digit());
    time.chars().map(as_digit).collect::<String>() == "0000-00-00T000000Z"
        && (number.is_empty() || number.strip_prefix('-').is_some_and(is_number))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    const EARLIER: &[u8] = b"\x89MCAP0\r\nearlier"; // the first bytes of a log

    #[test]
    fn unused_new_file_is_removed() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("run.mcap");
        drop(LogFile::claim(&path).unwrap());
        assert!(!path.exists());
        let mut begun = LogFile::claim(&path).unwrap();
        begun.emptied().unwrap();
        drop(begun);
        assert!(path.exists());
        fs::write(&path, EARLIER).unwrap();
        drop(LogFile::claim(&path).unwrap());
        assert_eq!(fs::read(&path).unwrap(), EARLIER);
    }

    #[test]
    fn explicit_log_replaces_only_a_log() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("cell.toml");
        fs::write(&path, "[robot]").unwrap();
        assert!(matches!(LogFile::claim(&path), Err(RecordError::Create { .. })));
        assert_eq!(fs::read_to_string(&path).unwrap(), "[robot]");
        fs::write(&path, EARLIER).unwrap();
        LogFile::claim(&path).unwrap().emptied().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"");
    }

    #[test]
    fn run_keeps_the_earlier_logs_of_its_job() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("linkbar.mcap");
        let day = Duration::from_secs(86_400);
        for _ in 0..3 {
            let mut log = LogFile::claim_free(directory.path(), "linkbar").unwrap();
            assert_eq!(log.path(), path);
            log.emptied().unwrap();
            fs::write(&path, EARLIER).unwrap();
            log.file.set_modified(SystemTime::UNIX_EPOCH + day).unwrap();
        }
        let mut names: Vec<_> = fs::read_dir(directory.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        let first = "linkbar-1970-01-02T000000Z";
        assert_eq!(names, [format!("{first}-2.mcap").as_str(), &format!("{first}.mcap"), "linkbar.mcap"]);
    }

    #[test]
    fn earlier_logs_are_known_by_their_names() {
        let log = Path::new("runs/linkbar.mcap");
        let is = |name: &str| is_earlier(log, Path::new(name));
        assert!(is("runs/linkbar-2026-11-27T214500Z.mcap") && is("runs/linkbar-2026-11-27T214500Z-12.mcap"));
        for other in
            ["linkbar.mcap", "linkbar-2.mcap", "linkbar-2026-11-27T214500Z-x.mcap", "linkbar-new.mcap"]
        {
            assert!(!is(other), "{other}");
        }
        assert!(!is("clevis-2026-11-27T214500Z.mcap") && !is("linkbar-2026-11-27T214500Z.html"));
    }

    #[test]
    fn second_run_gets_another_name_or_is_refused() {
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
