//! A pseudo-terminal that hosts open by a path.
//!
//! The path is a symbolic link to the slave. A pseudo-terminal has no modem lines: an open terminal stands for the
//! host's DTR. When a host closes it, it is prepared for the next one. A killed host leaves its exclusive lock
//! (TIOCEXCL), which other processes cannot reset. A new terminal then replaces the locked one.
//!
//! The program holds an abstract socket named after the path, which the kernel removes with the program. A link without
//! its socket is stale and may be replaced.

use std::{
    io,
    os::{
        fd::{AsFd, BorrowedFd, OwnedFd},
        linux::net::SocketAddrExt,
        unix::{
            ffi::OsStrExt,
            net::{SocketAddr, UnixDatagram},
        },
    },
    path::{Path, PathBuf},
};

use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    fs::{Mode, OFlags},
    io::Errno,
    pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt},
    termios::{OptionalActions, QueueSelector, tcflush, tcgetattr, tcsetattr},
};

const SLAVES: &str = "/dev/pts";

#[derive(Debug, thiserror::Error)]
pub enum PtyError {
    #[error("{} is the link of another rcs-cell that still runs: stop it, or choose another path", .0.display())]
    Alive(PathBuf),
    #[error("{} exists and is not a link that rcs-cell has left behind: remove it, or choose another path", .0.display())]
    Occupied(PathBuf),
    #[error("there is no directory for the link {}", .0.display())]
    NoDirectory(PathBuf),
    #[error("the link {} cannot be made: {source}", path.display())]
    Link { path: PathBuf, source: io::Error },
    #[error("no pseudo-terminal: {0}")]
    Terminal(#[from] Errno),
}

/// A pseudo-terminal and the link to it. Dropping it removes the link.
#[derive(Debug)]
pub struct Pty {
    master: OwnedFd,
    slave: PathBuf,
    path: PathBuf,
    _alive: UnixDatagram, // held while this program owns the link
}

impl Pty {
    /// Opens a pseudo-terminal and links it at `path`. On error nothing has been changed.
    pub fn open(path: &Path) -> Result<Self, PtyError> {
        let link_error = |source| PtyError::Link { path: path.to_owned(), source };
        // The link is identified by its directory, which stays the same when the link changes.
        let (Some(name), Some(parent)) = (path.file_name(), path.parent()) else {
            return Err(PtyError::Occupied(path.to_owned()));
        };
        let parent = if parent.as_os_str().is_empty() { Path::new(".") } else { parent };
        let directory = parent.canonicalize().map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => PtyError::NoDirectory(path.to_owned()),
            _ => link_error(error),
        })?;
        let path = directory.join(name);
        let alive = claim(&path).map_err(|error| match error.kind() {
            io::ErrorKind::AddrInUse => PtyError::Alive(path.clone()),
            _ => link_error(error),
        })?;
        match path.symlink_metadata() {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(link_error(error)),
            Ok(_) if path.read_link().is_ok_and(|target| target.starts_with(SLAVES)) => {}
            Ok(_) => return Err(PtyError::Occupied(path)),
        }
        let (master, slave) = terminal()?;
        point(&path, &slave).map_err(link_error)?;
        Ok(Self { master, slave, path, _alive: alive })
    }

    /// Path of the slave, the target of the link.
    #[must_use]
    pub fn slave(&self) -> &Path {
        &self.slave
    }

    /// File descriptor of the master, to wait for.
    #[must_use]
    pub fn fd(&self) -> BorrowedFd<'_> {
        self.master.as_fd()
    }

    #[must_use]
    pub fn has_host(&self) -> bool {
        let mut fds = [PollFd::new(&self.master, PollFlags::empty())];
        let asked = poll(&mut fds, Some(&Timespec { tv_sec: 0, tv_nsec: 0 }));
        asked.is_ok() && !fds.iter().any(|fd| fd.revents().contains(PollFlags::HUP))
    }

    /// Reads bytes of the host without blocking; 0 if there are none, or no host.
    pub fn read(&self, bytes: &mut [u8]) -> Result<usize, PtyError> {
        match rustix::io::read(&self.master, bytes) {
            Ok(count) => Ok(count),
            Err(Errno::AGAIN | Errno::IO | Errno::INTR) => Ok(0),
            Err(error) => Err(error.into()),
        }
    }

    /// Writes a byte for the host. If the terminal is full, the byte is lost, as on a serial line.
    pub fn write(&self, byte: u8) -> Result<(), PtyError> {
        match rustix::io::write(&self.master, &[byte]) {
            Ok(_) | Err(Errno::AGAIN | Errno::IO | Errno::INTR) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }

    /// Prepares the terminal for the next host. Returns true if a new terminal replaced it.
    pub fn renew(&mut self) -> Result<bool, PtyError> {
        if prepare(&self.slave).is_ok() {
            return Ok(false);
        }
        let (master, slave) = terminal()?;
        point(&self.path, &slave).map_err(|source| PtyError::Link { path: self.path.clone(), source })?;
        (self.master, self.slave) = (master, slave);
        Ok(true)
    }
}

impl Drop for Pty {
    fn drop(&mut self) {
        // Another program may have replaced the link.
        if self.path.read_link().is_ok_and(|target| target == self.slave) {
            // Nowhere is left to report an error; the next start replaces the stale link.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// Binds the abstract socket that shows that the path is in use.
fn claim(path: &Path) -> io::Result<UnixDatagram> {
    // A socket name has a limited length, so it contains only the end of a long path.
    let bytes = path.as_os_str().as_bytes();
    let end = &bytes[bytes.len().saturating_sub(90)..];
    UnixDatagram::bind_addr(&SocketAddr::from_abstract_name([b"rcs-cell:", end].concat())?)
}

/// Opens a pseudo-terminal in raw mode with a non-blocking master.
fn terminal() -> Result<(OwnedFd, PathBuf), PtyError> {
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
    grantpt(&master)?;
    unlockpt(&master)?;
    rustix::io::ioctl_fionbio(&master, true)?;
    let name = ptsname(&master, Vec::new())?;
    let slave = PathBuf::from(std::ffi::OsStr::from_bytes(name.as_bytes()));
    prepare(&slave)?;
    Ok((master, slave))
}

/// Sets raw mode and 9600 baud, and empties the buffers.
fn prepare(slave: &Path) -> Result<(), Errno> {
    let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC | OFlags::NONBLOCK;
    let slave = rustix::fs::open(slave, flags, Mode::empty())?;
    let mut settings = tcgetattr(&slave)?;
    settings.make_raw();
    settings.set_speed(9600)?;
    tcsetattr(&slave, OptionalActions::Now, &settings)?;
    tcflush(&slave, QueueSelector::IOFlush)
}

/// Makes `path` a link to `slave` atomically.
fn point(path: &Path, slave: &Path) -> io::Result<()> {
    let mut beside = path.as_os_str().to_owned();
    beside.push(format!(".{}", std::process::id()));
    std::os::unix::fs::symlink(slave, &beside)?;
    std::fs::rename(&beside, path).inspect_err(|_| {
        let _ = std::fs::remove_file(&beside);
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{
        fs::{self, File, OpenOptions},
        io::{Read, Write},
    };

    fn host(path: &Path) -> File {
        OpenOptions::new().read(true).write(true).open(path).unwrap()
    }

    #[test]
    fn all_bytes_pass_while_a_host_connects_and_disconnects() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("t3");
        let mut pty = Pty::open(&path).unwrap();
        assert!(!pty.has_host());
        let mut bytes = [0; 512];
        for round in 0..3 {
            let mut host = host(&path);
            assert!(pty.has_host(), "round {round}");
            let all: Vec<u8> = (0..=255).collect();
            host.write_all(&all).unwrap();
            assert_eq!(pty.read(&mut bytes).unwrap(), 256);
            assert_eq!(bytes[..256], all);
            pty.write(0x11).unwrap();
            let mut one = [0];
            host.read_exact(&mut one).unwrap();
            assert_eq!(one, [0x11]);
            // A byte that no host reads is gone when the next host connects.
            pty.write(0x22).unwrap();
            drop(host);
            assert!(!pty.has_host());
            pty.renew().unwrap();
            assert_eq!(pty.read(&mut bytes).unwrap(), 0);
        }
    }

    #[test]
    fn the_link_is_removed_and_a_dead_one_is_replaced() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("t3");
        let first = Pty::open(&path).unwrap();
        assert_eq!(path.read_link().unwrap(), first.slave());
        assert!(matches!(Pty::open(&path), Err(PtyError::Alive(_))));
        drop(first);
        assert!(path.symlink_metadata().is_err());
        // A killed program leaves such a stale link.
        std::os::unix::fs::symlink("/dev/pts/99999", &path).unwrap();
        drop(Pty::open(&path).unwrap());
        assert!(path.symlink_metadata().is_err());
    }

    #[test]
    fn files_of_other_programs_are_kept() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("t3");
        fs::write(&path, "precious").unwrap();
        assert!(matches!(Pty::open(&path), Err(PtyError::Occupied(_))));
        assert_eq!(fs::read_to_string(&path).unwrap(), "precious");
        assert!(matches!(Pty::open(&place.path().join("none/t3")), Err(PtyError::NoDirectory(_))));
        let link = place.path().join("link");
        std::os::unix::fs::symlink(&path, &link).unwrap();
        assert!(matches!(Pty::open(&link), Err(PtyError::Occupied(_))));
    }
}
