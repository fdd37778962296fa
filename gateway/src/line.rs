//! A Unix socket with a session: bytes in and out without blocking, except in [`Line::wait`].

use std::{
    io::{self, Read as _, Write as _},
    net::Shutdown,
    os::{
        fd::{AsFd as _, BorrowedFd},
        unix::net::UnixStream,
    },
    time::{Duration, Instant},
};

use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    net::sockopt,
    process::geteuid,
};

/// Bytes that are read at once.
const CHUNK: usize = 8192;

/// A connected socket.
#[derive(Debug)]
pub struct Line {
    stream: UnixStream,
    /// Bytes that the system has not accepted yet.
    pending: Vec<u8>,
}

impl Line {
    /// A line over a socket whose other end belongs to this user.
    ///
    /// # Errors
    /// Errors of the system; [`io::ErrorKind::PermissionDenied`] for another user.
    pub fn new(stream: UnixStream) -> io::Result<Self> {
        let (expected, found) = (geteuid(), sockopt::socket_peercred(&stream)?.uid);
        if expected != found {
            let why = format!("expected user {}, found user {}", expected.as_raw(), found.as_raw());
            return Err(io::Error::new(io::ErrorKind::PermissionDenied, why));
        }
        stream.set_nonblocking(true)?;
        Ok(Self { stream, pending: Vec::new() })
    }

    /// True if the system has accepted all bytes to send.
    #[must_use]
    pub const fn is_flushed(&self) -> bool {
        self.pending.is_empty()
    }

    /// Send bytes, which are removed from `bytes`; what the system does not accept waits for the next call.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn send(&mut self, bytes: &mut Vec<u8>) -> io::Result<()> {
        self.pending.append(bytes);
        while !self.pending.is_empty() {
            match (&self.stream).write(&self.pending) {
                Ok(0) => return Err(io::ErrorKind::WriteZero.into()),
                Ok(count) => drop(self.pending.drain(..count)),
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Ok(()),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Pass received bytes to `take`; false if the other side has closed the connection.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn receive(&mut self, take: impl FnOnce(&[u8])) -> io::Result<bool> {
        let mut buffer = [0; CHUNK];
        match (&self.stream).read(&mut buffer) {
            Ok(count) => {
                take(&buffer[..count]);
                Ok(count > 0)
            }
            Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted) => {
                Ok(true)
            }
            Err(error) if error.kind() == io::ErrorKind::ConnectionReset => Ok(false),
            Err(error) => Err(error),
        }
    }

    /// Wait until bytes can be read (returns true), pending bytes can be written, `wake` is readable, or the time
    /// `until` has come.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn wait(&self, wake: Option<BorrowedFd<'_>>, until: Option<Instant>) -> io::Result<bool> {
        let write = if self.is_flushed() { PollFlags::empty() } else { PollFlags::OUT };
        let socket = self.stream.as_fd();
        let mut ready = [
            PollFd::from_borrowed_fd(socket, PollFlags::IN | write),
            PollFd::from_borrowed_fd(wake.unwrap_or(socket), PollFlags::IN),
        ];
        let count = if wake.is_some() { 2 } else { 1 };
        // Rounded up: a wait that ends before the time would be followed by many short ones.
        let left =
            until.map(|until| until.saturating_duration_since(Instant::now()) + Duration::from_millis(1));
        let left = left.and_then(|left| Timespec::try_from(left).ok());
        match poll(&mut ready[..count], left.as_ref()) {
            Ok(_) => Ok(ready[0].revents().intersects(PollFlags::IN | PollFlags::HUP | PollFlags::ERR)),
            Err(rustix::io::Errno::INTR) => Ok(false),
            Err(error) => Err(error.into()),
        }
    }

    /// Send the remaining bytes and close the connection, at the latest at the time `until`. Bytes that are received
    /// meanwhile are dropped: the system may discard sent bytes if others are unread.
    pub fn finish(mut self, bytes: &mut Vec<u8>, until: Instant) {
        let mut is_open = self.send(bytes).is_ok();
        while is_open && !self.is_flushed() && Instant::now() < until {
            is_open = self.wait(None, Some(until)).and_then(|_| self.send(bytes)).is_ok();
        }
        // It may be closed already.
        let _ = self.stream.shutdown(Shutdown::Write);
        while is_open && Instant::now() < until {
            let ready = self.wait(None, Some(until));
            is_open =
                ready.and_then(|ready| if ready { self.receive(|_| {}) } else { Ok(true) }).unwrap_or(false);
        }
    }
}
