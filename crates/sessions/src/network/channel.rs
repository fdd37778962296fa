//! Bytes of a session over a socket, with TLS between them or without. Nothing here blocks but
//! [`Channel::wait`].

use std::{
    io::{self, Read as _, Write as _},
    os::fd::{AsFd as _, BorrowedFd},
    time::{Duration, Instant},
};

use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    io::Errno,
};
use rustls::{Connection, pki_types::CertificateDer};

use super::{session::Session, socket::Socket};

/// Bytes that are read at once.
const CHUNK: usize = 8192;

/// A socket, with or without TLS.
pub(super) struct Channel {
    socket: Socket,
    tls: Option<Connection>,
    /// Bytes that the system has not accepted yet.
    pending: Vec<u8>,
}

impl Channel {
    pub fn new(socket: Socket, tls: Option<Connection>) -> io::Result<Self> {
        socket.prepare()?;
        Ok(Self { socket, tls, pending: Vec::new() })
    }

    /// The certificate of the other side, once the handshake is over.
    pub fn certificate(&self) -> Option<&CertificateDer<'static>> {
        self.tls.as_ref().and_then(|tls| tls.peer_certificates()).and_then(<[_]>::first)
    }

    /// Refuse a socket in the file system whose other end belongs to another user.
    pub fn check_user(&self) -> io::Result<()> {
        self.socket.check_user()
    }

    /// True if the system has accepted all bytes to send.
    pub const fn is_flushed(&self) -> bool {
        self.pending.is_empty()
    }

    /// Send the output of a session, as far as the system accepts it; the rest waits for the next call.
    pub fn send(&mut self, session: &mut Session) -> io::Result<()> {
        self.send_bytes(session.output())
    }

    /// Like [`Channel::send`] for plain bytes, which are removed from `plain`.
    pub fn send_bytes(&mut self, plain: &mut Vec<u8>) -> io::Result<()> {
        match &mut self.tls {
            None => self.pending.append(plain),
            Some(tls) => {
                tls.writer().write_all(plain)?;
                plain.clear();
            }
        }
        self.flush()
    }

    fn flush(&mut self) -> io::Result<()> {
        while let Some(tls) = self.tls.as_mut().filter(|tls| tls.wants_write()) {
            tls.write_tls(&mut self.pending)?;
        }
        while !self.pending.is_empty() {
            match (&self.socket).write(&self.pending) {
                Ok(0) => return Err(io::ErrorKind::WriteZero.into()),
                Ok(count) => drop(self.pending.drain(..count)),
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Ok(()),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Pass received bytes to a session; false if the other side has closed the connection.
    ///
    /// # Errors
    /// Errors of the system; [`io::ErrorKind::InvalidData`] for errors of TLS, after the alert was sent to the other
    /// side; [`io::ErrorKind::UnexpectedEof`] if the connection ended without the end of TLS.
    pub fn receive(&mut self, session: &mut Session, now: Instant) -> io::Result<bool> {
        self.receive_bytes(|bytes| session.receive(bytes, now))
    }

    /// Like [`Channel::receive`], passing the bytes to `take`.
    ///
    /// # Errors
    /// As [`Channel::receive`].
    pub fn receive_bytes(&mut self, mut take: impl FnMut(&[u8])) -> io::Result<bool> {
        let mut buffer = [0; CHUNK];
        let Some(tls) = &mut self.tls else {
            let read = (&self.socket).read(&mut buffer);
            return or_later(read.map(|count| {
                take(&buffer[..count]);
                count > 0
            }));
        };
        let cut = || io::Error::new(io::ErrorKind::UnexpectedEof, "the connection was cut");
        let more = or_later(tls.read_tls(&mut &self.socket).map(|count| count > 0))?;
        if let Err(error) = tls.process_new_packets() {
            // The other side may have closed already and not get the alert.
            let _ = self.flush();
            return Err(io::Error::new(io::ErrorKind::InvalidData, error));
        }
        loop {
            match tls.reader().read(&mut buffer) {
                Ok(0) => return Ok(false),
                Ok(count) => take(&buffer[..count]),
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => break,
                Err(_) => return Err(cut()),
            }
        }
        if more { Ok(true) } else { Err(cut()) }
    }

    /// Wait until bytes can be read (returns true), pending bytes can be written, `wake` is readable, or the time
    /// `until` has come.
    pub fn wait(&self, wake: Option<BorrowedFd<'_>>, until: Option<Instant>) -> io::Result<bool> {
        let write = if self.is_flushed() { PollFlags::empty() } else { PollFlags::OUT };
        let socket = self.socket.as_fd();
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
            Err(Errno::INTR) => Ok(false),
            Err(error) => Err(error.into()),
        }
    }

    /// Send the remaining bytes, then a TLS close_notify, and close this direction; takes at most until the time
    /// `until`.
    pub fn finish(&mut self, session: &mut Session, until: Instant) {
        let mut sent = self.send(session);
        if let Some(tls) = &mut self.tls {
            tls.send_close_notify();
            sent = sent.and_then(|()| self.flush());
        }
        while sent.is_ok() && !self.is_flushed() && Instant::now() < until {
            sent = self.wait(None, Some(until)).and_then(|_| self.flush());
        }
        self.socket.finish();
    }

    /// Continue to read after [`Channel::finish`] until the other side has closed, or until a time: if a socket is
    /// closed with unread bytes, the system may discard the bytes it has sent.
    pub fn drain(&self, until: Instant) {
        let mut buffer = [0; CHUNK];
        while Instant::now() < until {
            match self.wait(None, Some(until)).and_then(|ready| {
                if ready {
                    or_later((&self.socket).read(&mut buffer).map(|count| count > 0))
                } else {
                    Ok(true)
                }
            }) {
                Ok(true) => {}
                Ok(false) | Err(_) => return,
            }
        }
    }
}

/// Convert the result of a read: that no bytes have been received yet is not an error.
fn or_later(read: io::Result<bool>) -> io::Result<bool> {
    use io::ErrorKind::{Interrupted, WouldBlock};
    match read {
        Err(error) if matches!(error.kind(), WouldBlock | Interrupted) => Ok(true),
        other => other,
    }
}
