//! Replaces files so that neither a full disk nor a crash leaves half a file, and no input is lost.
//!
//! | for | call |
//! |---|---|
//! | the output of a command, before the work | [`check_output`] |
//! | a text that a person edits | [`replace_text`] |
//! | any other file | [`replace`] |
//!
//! The last two write a temporary file in the same directory, with mode and owner of the old file, synchronise it with
//! the disk, and rename it. For a symbolic link, they replace its target.

use std::{
    fs::{self, File, Metadata, OpenOptions},
    io::{self, ErrorKind, Read as _, Write as _},
    os::unix::fs::{MetadataExt as _, PermissionsExt as _, fchown},
    path::{Path, PathBuf},
    process,
};

use crate::{
    carried,
    files::{self, expect_regular},
};

const MAX_LINKS: usize = 40; // as in Linux
/// Byte order mark of UTF-8.
const MARK: &str = "\u{feff}";

/// A format of an output file, recognised by the first bytes of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A log.
    Mcap,
    /// A page for a browser.
    Html,
    /// A page of documentation: the first line is a heading.
    Markdown,
    /// A robot description.
    Urdf,
}

impl Format {
    const fn name(self) -> &'static str {
        match self {
            Self::Mcap => "an MCAP log",
            Self::Html => "an HTML page",
            Self::Markdown => "a Markdown page",
            Self::Urdf => "a URDF description",
        }
    }

    /// `start` has the first bytes of a file.
    fn begins(self, start: &[u8]) -> bool {
        let text = start.strip_prefix(MARK.as_bytes()).unwrap_or(start).trim_ascii_start();
        let tag =
            |tag: &str| text.get(..tag.len()).is_some_and(|found| found.eq_ignore_ascii_case(tag.as_bytes()));
        match self {
            Self::Mcap => start.starts_with(b"\x89MCAP0\r\n"),
            Self::Html => tag("<!doctype html") || tag("<html"),
            Self::Markdown => text.starts_with(b"# "),
            Self::Urdf => tag("<?xml") || tag("<robot"),
        }
    }
}

/// Checks that the output of a command replaces no input and no file of another format. Fails with
/// [`ErrorKind::InvalidInput`] for an input (same device and inode) or a file that is not regular, and with
/// [`ErrorKind::AlreadyExists`] for another format.
pub fn check_output<'a>(
    path: &Path,
    format: Format,
    inputs: impl IntoIterator<Item = &'a Path>,
) -> io::Result<()> {
    keep_inputs(path, inputs)?;
    keep_others(path, format)
}

/// Refuses an output that is an input. Compares device and inode, or the paths if a file does not exist.
fn keep_inputs<'a>(output: &Path, inputs: impl IntoIterator<Item = &'a Path>) -> io::Result<()> {
    let identity = |path: &Path| fs::metadata(path).ok().map(|found| (found.dev(), found.ino()));
    let is_output = |input: &&Path| match (identity(output), identity(input)) {
        (None, None) => place_of(output).is_some_and(|place| place_of(input) == Some(place)),
        (found, other) => found == other,
    };
    match inputs.into_iter().find(is_output) {
        Some(input) => Err(io::Error::new(
            ErrorKind::InvalidInput,
            format!("it is the input {}: name another file for the output", input.display()),
        )),
        None => Ok(()),
    }
}

/// The path with its directory resolved. `None` if the directory does not exist.
fn place_of(path: &Path) -> Option<PathBuf> {
    let directory = path.parent().filter(|directory| !directory.as_os_str().is_empty());
    Some(fs::canonicalize(directory.unwrap_or(Path::new("."))).ok()?.join(path.file_name()?))
}

/// Refuses to replace a file of another format. An empty file has every format.
fn keep_others(output: &Path, format: Format) -> io::Result<()> {
    let file = match files::open(output) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        opened => opened?,
    };
    let mut start = Vec::new();
    file.take(256).read_to_end(&mut start)?;
    if start.is_empty() || format.begins(&start) {
        return Ok(());
    }
    let why = format!(
        "the file exists and is not {}: name another file for the output, or remove this one",
        format.name()
    );
    Err(io::Error::new(ErrorKind::AlreadyExists, why))
}

/// Replaces a file's text, but keeps its line ends and byte order mark. `text` has LF. Fails like [`replace`].
pub fn replace_text(path: &Path, text: &str) -> io::Result<()> {
    let before = match files::read(path, files::TEXT) {
        Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
        read => read?,
    };
    let text = text.strip_prefix(MARK).unwrap_or(text).replace("\r\n", "\n");
    let mark = if before.starts_with(MARK.as_bytes()) { MARK } else { "" };
    replace(path, format!("{mark}{}", text.replace('\n', line_end(&before))).as_bytes())
}

/// The line end of the first line: LF, CR LF or CR.
fn line_end(text: &[u8]) -> &'static str {
    let mut bytes = text.iter();
    match bytes.find(|byte| matches!(byte, b'\n' | b'\r')) {
        Some(b'\r') if bytes.next() == Some(&b'\n') => "\r\n",
        Some(b'\r') if !text.contains(&b'\n') => "\r",
        _ => "\n",
    }
}

/// Replaces or creates a file. The old content stays until the new one is complete on the disk, and after an error.
/// Fails with [`ErrorKind::InvalidInput`] for a file that is not regular or is built in, and with
/// [`ErrorKind::PermissionDenied`] if the owner cannot be kept.
pub fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if carried::inside(path).is_some() {
        let why = "the file is built into this program: write the built-in data to a directory first (`rcs-run init`)";
        return Err(io::Error::new(ErrorKind::InvalidInput, why));
    }
    let target = target(path)?;
    let old = match fs::metadata(&target) {
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        found => Some(found?),
    };
    if let Some(old) = &old {
        expect_regular(old.file_type())?;
    }
    let directory = target.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    let temporary = directory.join(format!(".{name}.{}.new", process::id()));
    let written = write_new(&temporary, bytes, old.as_ref()).and_then(|()| fs::rename(&temporary, &target));
    if written.is_err() {
        let _ = fs::remove_file(&temporary); // the error of the write is the one to report
    }
    written?;
    File::open(directory)?.sync_all()
}

/// Writes a file with mode and owner of the old one, synchronised with the disk.
fn write_new(path: &Path, bytes: &[u8], old: Option<&Metadata>) -> io::Result<()> {
    // A killed process with the same number may have left the temporary file.
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    let mut file = OpenOptions::new().write(true).create_new(true).open(path)?;
    if let Some(old) = old {
        let new = file.metadata()?;
        if (new.uid(), new.gid()) != (old.uid(), old.gid()) {
            fchown(&file, Some(old.uid()), Some(old.gid())).map_err(|error| {
                let why =
                    format!("the owner of the file ({}:{}) cannot be kept: {error}", old.uid(), old.gid());
                io::Error::new(error.kind(), why)
            })?;
        }
        file.set_permissions(fs::Permissions::from_mode(old.mode() & 0o7777))?;
    }
    file.write_all(bytes)?;
    file.sync_all()
}

/// The file after all symbolic links; it need not exist.
fn target(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&path) {
            Ok(link) => path = path.parent().unwrap_or(Path::new("")).join(link),
            Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::NotFound) => {
                return Ok(path);
            }
            Err(error) => return Err(error),
        }
    }
    let why = format!("more than {MAX_LINKS} symbolic links: {}", path.display());
    Err(io::Error::new(ErrorKind::InvalidInput, why))
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::symlink;

    use super::*;

    fn entries(directory: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(directory)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn replace_follows_links_and_keeps_the_mode() {
        let place = tempfile::tempdir().unwrap();
        let (file, link) = (place.path().join("file"), place.path().join("link"));
        fs::write(&file, "old").unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
        symlink("file", &link).unwrap();
        replace(&link, b"new").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&file).unwrap(), b"new");
        assert_eq!(fs::metadata(&file).unwrap().mode() & 0o7777, 0o640);
        assert_eq!(entries(place.path()), ["file", "link"]);
    }

    #[test]
    fn replace_creates_the_target_of_a_dangling_link() {
        let place = tempfile::tempdir().unwrap();
        symlink("missing", place.path().join("link")).unwrap();
        replace(&place.path().join("link"), b"new").unwrap();
        assert_eq!(fs::read(place.path().join("missing")).unwrap(), b"new");
    }

    #[test]
    fn replace_refuses_loops_devices_directories_and_built_in_files() {
        let place = tempfile::tempdir().unwrap();
        let link = place.path().join("loop");
        symlink("loop", &link).unwrap();
        for path in [&link, Path::new("/dev/null"), place.path(), Path::new("shipped:data/cell.toml")] {
            assert_eq!(replace(path, b"").unwrap_err().kind(), ErrorKind::InvalidInput, "{}", path.display());
        }
    }

    #[test]
    fn a_failed_write_leaves_only_the_old_file() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("file");
        fs::write(&file, "old").unwrap();
        let temporary = place.path().join(format!(".file.{}.new", process::id()));
        // A directory with the temporary file's name makes the write fail for every user.
        fs::create_dir(&temporary).unwrap();
        replace(&file, b"new").unwrap_err();
        assert_eq!(fs::read(&file).unwrap(), b"old");
    }

    #[test]
    fn replace_text_keeps_line_ends_and_byte_order_mark() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("file");
        for (before, after) in [
            ("\u{feff}a\r\nb\r\n", "\u{feff}x\r\ny\r\n"),
            ("a\rb\r", "x\ry\r"),
            ("a\nb\n", "x\ny\n"),
            ("", "x\ny\n"),
        ] {
            fs::write(&file, before).unwrap();
            replace_text(&file, "x\ny\n").unwrap();
            assert_eq!(fs::read_to_string(&file).unwrap(), after);
        }
    }

    #[test]
    fn an_output_is_not_an_input_that_does_not_exist_yet() {
        let place = tempfile::tempdir().unwrap();
        let (file, other) = (place.path().join("a"), place.path().join("d/../a"));
        fs::create_dir(place.path().join("d")).unwrap();
        for input in [&file, &other] {
            let error = check_output(&file, Format::Mcap, [input.as_path()]).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::InvalidInput);
        }
        assert!(check_output(&file, Format::Mcap, [place.path().join("b").as_path()]).is_ok());
    }

    #[test]
    fn an_output_is_not_an_input_under_any_name() {
        let place = tempfile::tempdir().unwrap();
        let (file, link, hard) = (place.path().join("a"), place.path().join("b"), place.path().join("c"));
        fs::write(&file, "").unwrap();
        symlink("a", &link).unwrap();
        fs::hard_link(&file, &hard).unwrap();
        for output in [&file, &link, &hard] {
            let error = check_output(output, Format::Mcap, [file.as_path()]).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::InvalidInput);
            assert!(error.to_string().contains("name another file"), "{error}");
        }
        assert!(check_output(&place.path().join("d"), Format::Mcap, [file.as_path()]).is_ok());
    }

    #[test]
    fn an_output_replaces_only_a_file_of_its_format() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("file");
        for (content, format, fits) in [
            ("", Format::Html, true),
            ("<!DOCTYPE html><html>", Format::Html, true),
            ("[robot]\nname = 1", Format::Mcap, false),
            ("# Title", Format::Markdown, true),
            ("plain", Format::Markdown, false),
            ("\u{feff}<?xml version=\"1.0\"?>", Format::Urdf, true),
            ("\u{89}MCAP0\r\n", Format::Html, false),
        ] {
            fs::write(&file, content).unwrap();
            let checked = check_output(&file, format, []).map_err(|error| error.kind());
            assert_eq!(checked.is_ok(), fits, "{content:?} as {format:?}");
            assert!(fits || checked.unwrap_err() == ErrorKind::AlreadyExists);
        }
    }
}
