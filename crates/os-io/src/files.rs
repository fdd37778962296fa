//! Reads files that a person or another program names. A FIFO blocks until another program writes to it, a terminal
//! until a key is pressed, and `/dev/zero` never ends. Therefore only regular files are read, up to a limit of size,
//! and files that are built into the program ([`carried`]).

use std::{
    fs::{self, File, FileType, OpenOptions},
    io::{self, ErrorKind, Read},
    os::unix::fs::{FileTypeExt, OpenOptionsExt},
    path::{Path, PathBuf},
};

use rustix::fs::OFlags;

use crate::carried;

/// Greatest length of a text file, bytes. Task data, jobs, cell descriptions and fault plans need some kilobytes.
pub const TEXT: u64 = 16 << 20;

/// Reads a regular file of at most `limit` bytes, without blocking. Fails with [`ErrorKind::InvalidInput`] for other
/// files, [`ErrorKind::FileTooLarge`], [`ErrorKind::OutOfMemory`].
pub fn read(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    if let Some(inside) = carried::inside(path) {
        let bytes = carried::read(inside)?;
        within(bytes.len(), limit)?;
        return Ok(bytes.to_vec());
    }
    let file = open(path)?;
    let length = file.metadata()?.len();
    let mut bytes = Vec::new();
    if length <= limit {
        // One byte more than the limit shows whether the file has grown during the read.
        file.take(limit.saturating_add(1)).read_to_end(&mut bytes)?;
    }
    within(bytes.len().max(usize::try_from(length).unwrap_or(usize::MAX)), limit)?;
    Ok(bytes)
}

fn within(length: usize, limit: u64) -> io::Result<()> {
    if u64::try_from(length).is_ok_and(|length| length <= limit) {
        return Ok(());
    }
    let why = format!("a file of at most {limit} bytes was expected, found {length} bytes");
    Err(io::Error::new(ErrorKind::FileTooLarge, why))
}

/// Returns true if a path names a directory.
#[must_use]
pub fn is_directory(path: &Path) -> bool {
    carried::inside(path).map_or_else(|| path.is_dir(), |inside| !carried::list(inside).is_empty())
}

/// Returns true if a path names a regular file.
#[must_use]
pub fn is_file(path: &Path) -> bool {
    carried::inside(path).map_or_else(|| path.is_file(), |inside| carried::read(inside).is_ok())
}

/// Returns true if `path` lies in `directory` after all symbolic links are resolved.
#[must_use]
pub fn lies_in(path: &Path, directory: &Path) -> bool {
    if carried::inside(directory).is_some() {
        return path.starts_with(directory);
    }
    let real = directory.canonicalize().and_then(|directory| Ok((path.canonicalize()?, directory)));
    real.is_ok_and(|(path, directory)| path.starts_with(directory))
}

/// Paths of the entries of a directory, sorted. Errors: [`ErrorKind::NotFound`] also for a built-in
/// directory that does not exist.
pub fn list(directory: &Path) -> io::Result<Vec<PathBuf>> {
    let mut paths = match carried::inside(directory) {
        Some(inside) => carried::list(inside),
        None => fs::read_dir(directory)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?,
    };
    if paths.is_empty() && carried::inside(directory).is_some() {
        return Err(io::Error::new(ErrorKind::NotFound, "no such directory is built into this program"));
    }
    paths.sort();
    Ok(paths)
}

/// Reads at most [`TEXT`] bytes of UTF-8; the byte order mark is optional, lines end with LF, CR LF or CR. Fails like
/// [`read`], and with [`ErrorKind::InvalidData`] that names the first line that is not UTF-8.
pub fn read_text(path: &Path) -> io::Result<String> {
    let text = String::from_utf8(read(path, TEXT)?).map_err(|error| {
        let good = error.as_bytes().get(..error.utf8_error().valid_up_to()).unwrap_or_default();
        let line = good.iter().filter(|byte| **byte == b'\n').count() + 1;
        let why = format!("line {line} is not UTF-8: save the file as UTF-8 or as plain ASCII");
        io::Error::new(ErrorKind::InvalidData, why)
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    Ok(if text.contains('\n') { text.to_owned() } else { text.replace('\r', "\n") })
}

/// Opens a regular file for reading. Fails like [`read`].
pub fn open(path: &Path) -> io::Result<File> {
    // The kind is checked before opening, which has side effects on some devices, and again afterwards.
    expect_regular(fs::metadata(path)?.file_type())?;
    let flags = OFlags::NONBLOCK | OFlags::NOCTTY;
    let file = OpenOptions::new().read(true).custom_flags(flags.bits().cast_signed()).open(path)?;
    expect_regular(file.metadata()?.file_type())?;
    Ok(file)
}

/// Opens a regular file for writing and creates it if it does not exist. Does not truncate it. Fails like [`read`].
pub fn create(path: &Path) -> io::Result<File> {
    match fs::metadata(path) {
        Ok(found) => expect_regular(found.file_type())?,
        Err(error) if error.kind() == ErrorKind::NotFound => {}
        Err(error) => return Err(error),
    }
    let flags = OFlags::NONBLOCK | OFlags::NOCTTY;
    let mut options = OpenOptions::new();
    options.write(true).create(true).truncate(false).custom_flags(flags.bits().cast_signed());
    let file = options.open(path)?;
    expect_regular(file.metadata()?.file_type())?;
    Ok(file)
}

/// Fails for everything but a regular file, with [`ErrorKind::InvalidInput`] and the kind found.
pub fn expect_regular(kind: FileType) -> io::Result<()> {
    let found = match kind {
        kind if kind.is_file() => return Ok(()),
        kind if kind.is_dir() => "a directory",
        kind if kind.is_fifo() => "a FIFO",
        kind if kind.is_socket() => "a socket",
        kind if kind.is_char_device() || kind.is_block_device() => "a device",
        _ => "another kind of file",
    };
    Err(io::Error::new(ErrorKind::InvalidInput, format!("a regular file was expected, found {found}")))
}

#[cfg(test)]
mod tests {
    use std::os::unix::net::UnixListener;

    use rustix::fs::{CWD, Mode};

    use super::*;

    fn why(path: &Path) -> String {
        read(path, 100).unwrap_err().to_string()
    }

    #[test]
    fn only_regular_files_are_read() {
        let place = tempfile::tempdir().unwrap();
        let (fifo, socket, file) = (place.path().join("f"), place.path().join("s"), place.path().join("r"));
        rustix::fs::mkfifoat(CWD, &fifo, Mode::RUSR | Mode::WUSR).unwrap();
        let _listener = UnixListener::bind(&socket).unwrap();
        fs::write(&file, "text").unwrap();
        for (path, found) in [
            (fifo.as_path(), "a FIFO"),
            (&socket, "a socket"),
            (place.path(), "a directory"),
            (Path::new("/dev/zero"), "a device"),
            (Path::new("/dev/null"), "a device"),
        ] {
            assert_eq!(why(path), format!("a regular file was expected, found {found}"));
        }
        assert_eq!(read(&file, 4).unwrap(), b"text");
        let link = place.path().join("l");
        std::os::unix::fs::symlink(&file, &link).unwrap();
        assert_eq!(read_text(&link).unwrap(), "text");
    }

    #[test]
    fn a_link_out_of_a_directory_does_not_lie_in_it() {
        let (place, other) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let (inside, outside) = (place.path().join("in.blk"), other.path().join("out.blk"));
        fs::write(&inside, "").unwrap();
        fs::write(&outside, "").unwrap();
        let link = |name: &str, to: &Path| {
            let link = place.path().join(name);
            std::os::unix::fs::symlink(to, &link).unwrap();
            link
        };
        let lies = |path: &Path| lies_in(path, place.path());
        assert!(lies(&inside) && lies(&link("a.blk", &inside)));
        assert!(!lies(&outside) && !lies(&link("b.blk", &outside)) && !lies(&place.path().join("none.blk")));
        assert!(!lies(&link("folder", other.path()).join("out.blk")));
    }

    #[test]
    fn a_file_is_not_read_beyond_the_limit() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("large");
        fs::write(&path, [0; 101]).unwrap();
        assert_eq!(why(&path), "a file of at most 100 bytes was expected, found 101 bytes");
        // A sparse file takes no room on the disk and must take none in memory.
        File::create(&path).unwrap().set_len(1 << 36).unwrap();
        assert_eq!(read(&path, TEXT).unwrap_err().kind(), ErrorKind::FileTooLarge);
        // The kernel reports a length of 0 for files in `/proc`.
        assert_eq!(read(Path::new("/proc/self/maps"), 10).unwrap_err().kind(), ErrorKind::FileTooLarge);
    }

    #[test]
    fn text_is_utf_8() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("text");
        fs::write(&path, b"\xFF").unwrap();
        assert_eq!(read_text(&path).unwrap_err().kind(), ErrorKind::InvalidData);
    }
}
