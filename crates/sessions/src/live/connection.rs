//! The connection of a client.

use std::{
    io::{self, ErrorKind, Read, Write},
    mem,
    net::TcpStream,
    time::{Duration, Instant},
};

/// A connection. During the handshake, reads wait up to a time limit and then fail; afterwards they never wait.
pub struct Connection {
    stream: TcpStream,
    until: Option<Instant>,
    /// True if the last write was blocked.
    is_full: bool,
    /// True if a write has succeeded after a blocked one, which shows that the client has read.
    has_drained: bool,
}

impl Connection {
    /// A connection with a time limit for its handshake.
    pub fn new(stream: TcpStream, handshake: Duration) -> io::Result<Self> {
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(handshake))?;
        Ok(Self { stream, until: Some(Instant::now() + handshake), is_full: false, has_drained: false })
    }

    /// Ends the handshake: reads and writes never wait from now on.
    pub fn never_wait(&mut self) -> io::Result<()> {
        self.until = None;
        self.stream.set_nonblocking(true)
    }

    /// Returns true if a write has succeeded after a blocked one since the last call: the client has read.
    pub fn has_drained(&mut self) -> bool {
        mem::take(&mut self.has_drained)
    }
}

impl Read for Connection {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if let Some(until) = self.until {
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Err(ErrorKind::TimedOut.into());
            }
            self.stream.set_read_timeout(Some(left))?;
        }
        self.stream.read(buffer)
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
