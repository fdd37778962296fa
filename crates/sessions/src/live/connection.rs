//! The connection of a client.

use std::{
    io::{self, ErrorKind, Read, Write},
    mem,
    net::TcpStream,
    os::unix::net::UnixStream,
    time::{Duration, Instant},
};

#[derive(Debug)]
pub enum Stream {
    Local(TcpStream),
    /// The gateway, which connects for a person on the network. It belongs to the user of this process.
    Gateway(UnixStream),
}

impl Stream {
    pub fn set_nonblocking(&self) -> io::Result<()> {
        match self {
            Self::Local(stream) => stream.set_nonblocking(true),
            Self::Gateway(stream) => stream.set_nonblocking(true),
        }
    }

    fn limit(&self, writing: Duration) -> io::Result<()> {
        match self {
            Self::Local(stream) => {
                stream.set_nodelay(true)?;
                stream.set_write_timeout(Some(writing))
            }
            Self::Gateway(stream) => stream.set_write_timeout(Some(writing)),
        }
    }

    fn read(&self, buffer: &mut [u8], limit: Option<Duration>) -> io::Result<usize> {
        match self {
            Self::Local(stream) => {
                limit.map_or(Ok(()), |limit| stream.set_read_timeout(Some(limit)))?;
                (&*stream).read(buffer)
            }
            Self::Gateway(stream) => {
                limit.map_or(Ok(()), |limit| stream.set_read_timeout(Some(limit)))?;
                (&*stream).read(buffer)
            }
        }
    }
}

impl Write for Stream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Local(stream) => stream.write(bytes),
            Self::Gateway(stream) => stream.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Local(stream) => stream.flush(),
            Self::Gateway(stream) => stream.flush(),
        }
    }
}

/// A connection. During the handshake, reads wait up to a time limit and then fail; afterwards they never wait.
pub struct Connection {
    stream: Stream,
    until: Option<Instant>,
    is_full: bool,     // the last write was blocked
    has_drained: bool, // a write has succeeded after a blocked one, which shows that the client has read
}

impl Connection {
    /// A connection with a time limit for its handshake.
    pub fn new(stream: Stream, handshake: Duration) -> io::Result<Self> {
        stream.limit(handshake)?;
        Ok(Self { stream, until: Some(Instant::now() + handshake), is_full: false, has_drained: false })
    }

    /// Ends the handshake: reads and writes never wait from now on.
    pub fn never_wait(&mut self) -> io::Result<()> {
        self.until = None;
        self.stream.set_nonblocking()
    }

    /// Returns true if, since the last call, a write has succeeded after a blocked one, because the client has read.
    pub fn has_drained(&mut self) -> bool {
        mem::take(&mut self.has_drained)
    }
}

impl Read for Connection {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let left = self.until.map(|until| until.saturating_duration_since(Instant::now()));
        if left.is_some_and(|left| left.is_zero()) {
            return Err(ErrorKind::TimedOut.into());
        }
        self.stream.read(buffer, left)
    }
}

impl Write for Connection {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.stream.write(bytes);
        match &written {
            Ok(1..) => self.has_drained |= mem::take(&mut self.is_full),
            Ok(0) => {}
            Err(error) => self.is_full |= error.kind() == ErrorKind::WouldBlock,
        }
        written
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}
