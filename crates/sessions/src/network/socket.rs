//! A connected socket of either kind, non-blocking.

use std::{
    io::{self, Read, Write},
    net::{Shutdown, TcpStream},
    os::{
        fd::{AsFd, BorrowedFd},
        unix::net::UnixStream,
    },
};

use rustix::{net::sockopt, process::geteuid};

/// A connected socket.
#[derive(Debug)]
pub(super) enum Socket {
    Unix(UnixStream),
    Tcp(TcpStream),
}

impl Socket {
    pub fn try_clone(&self) -> io::Result<Self> {
        Ok(match self {
            Self::Unix(stream) => Self::Unix(stream.try_clone()?),
            Self::Tcp(stream) => Self::Tcp(stream.try_clone()?),
        })
    }

    /// Do not block; send each mailgram at once (otherwise TCP may delay some for up to 40 ms, a whole tick).
    pub fn prepare(&self) -> io::Result<()> {
        match self {
            Self::Unix(stream) => stream.set_nonblocking(true),
            Self::Tcp(stream) => {
                stream.set_nodelay(true)?;
                stream.set_nonblocking(true)
            }
        }
    }

    /// Refuse a socket in the file system whose other end belongs to another user.
    ///
    /// # Errors
    /// [`io::ErrorKind::PermissionDenied`], with both users.
    pub fn check_user(&self) -> io::Result<()> {
        let Self::Unix(stream) = self else { return Ok(()) };
        let (expected, found) = (geteuid(), sockopt::socket_peercred(stream)?.uid);
        if expected == found {
            return Ok(());
        }
        let why = format!("user {} was expected, found user {}", expected.as_raw(), found.as_raw());
        Err(io::Error::new(io::ErrorKind::PermissionDenied, why))
    }

    /// Close the sending direction; the other side reads the bytes in transit, and then the end.
    pub fn finish(&self) {
        self.shut(Shutdown::Write);
    }

    /// Close both directions at once.
    pub fn shut_down(&self) {
        self.shut(Shutdown::Both);
    }

    fn shut(&self, how: Shutdown) {
        // It may be closed already.
        let _ = match self {
            Self::Unix(stream) => stream.shutdown(how),
            Self::Tcp(stream) => stream.shutdown(how),
        };
    }
}

impl AsFd for Socket {
    fn as_fd(&self) -> BorrowedFd<'_> {
        match self {
            Self::Unix(stream) => stream.as_fd(),
            Self::Tcp(stream) => stream.as_fd(),
        }
    }
}

impl Read for &Socket {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match self {
            Socket::Unix(stream) => (&mut &*stream).read(bytes),
            Socket::Tcp(stream) => (&mut &*stream).read(bytes),
        }
    }
}

impl Write for &Socket {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Socket::Unix(stream) => (&mut &*stream).write(bytes),
            Socket::Tcp(stream) => (&mut &*stream).write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
