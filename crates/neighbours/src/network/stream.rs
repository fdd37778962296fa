//! A connected socket of either kind, and the frames that go over it.

use std::{
    io::{self, Read, Write},
    net::{Shutdown, TcpStream},
    os::unix::net::UnixStream,
    time::Duration,
};

use super::{
    frame::{Frame, FrameError, MAX_FRAME},
    office::Outlet,
    peer::Inlet,
    seal::{SEAL, Seal},
};

/// How often whoever reads asks whether the silence is too long.
const ROUND: Duration = Duration::from_secs(1);

/// A connected socket.
pub(super) enum Stream {
    Unix(UnixStream),
    Tcp(TcpStream),
}

impl Stream {
    pub fn try_clone(&self) -> io::Result<Self> {
        Ok(match self {
            Self::Unix(stream) => Self::Unix(stream.try_clone()?),
            Self::Tcp(stream) => Self::Tcp(stream.try_clone()?),
        })
    }

    /// How long reading and writing may take. Mailgrams are short, and are not kept back to be sent together.
    pub fn prepare(&self, limit: Duration) -> io::Result<()> {
        self.read_within(limit)?;
        match self {
            Self::Unix(stream) => stream.set_write_timeout(Some(limit)),
            Self::Tcp(stream) => {
                stream.set_nodelay(true)?;
                stream.set_write_timeout(Some(limit))
            }
        }
    }

    /// How long reading may take.
    fn read_within(&self, limit: Duration) -> io::Result<()> {
        match self {
            Self::Unix(stream) => stream.set_read_timeout(Some(limit)),
            Self::Tcp(stream) => stream.set_read_timeout(Some(limit)),
        }
    }

    /// Reading may take as long as it likes.
    pub fn unlimited(&self) -> io::Result<()> {
        match self {
            Self::Unix(stream) => stream.set_read_timeout(None),
            Self::Tcp(stream) => stream.set_read_timeout(None),
        }
    }

    pub fn shut_down(&self) {
        // It may be closed already.
        let _ = match self {
            Self::Unix(stream) => stream.shutdown(Shutdown::Both),
            Self::Tcp(stream) => stream.shutdown(Shutdown::Both),
        };
    }
}

impl Read for Stream {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Unix(stream) => stream.read(bytes),
            Self::Tcp(stream) => stream.read(bytes),
        }
    }
}

impl Write for Stream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Unix(stream) => stream.write(bytes),
            Self::Tcp(stream) => stream.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Unix(stream) => stream.flush(),
            Self::Tcp(stream) => stream.flush(),
        }
    }
}

/// Frames that go out.
pub(super) struct Sender {
    stream: Stream,
    seal: Option<Seal>,
    /// The next frame has no seal even so.
    is_first: bool,
}

impl Sender {
    /// Frames without a seal, until there is one.
    pub const fn new(stream: Stream) -> Self {
        Self { stream, seal: None, is_first: false }
    }

    /// From here on frames have a seal.
    pub fn seal(&mut self, seal: Option<Seal>) {
        self.seal = seal;
    }

    /// Behind the next frame all have a seal. That one is a welcome or last words: who reads it has no key yet.
    pub fn seal_behind_first(&mut self, seal: Option<Seal>) {
        (self.seal, self.is_first) = (seal, true);
    }
}

impl Outlet for Sender {
    fn send(&mut self, frame: &Frame) -> io::Result<()> {
        let is_first = std::mem::take(&mut self.is_first);
        let Some(seal) = self.seal.as_mut().filter(|_| !is_first) else {
            return self.stream.write_all(frame.bytes());
        };
        // In one piece: a frame without its seal is not worth a packet.
        let mut bytes = [0; MAX_FRAME + SEAL];
        let length = frame.bytes().len();
        bytes[..length].copy_from_slice(frame.bytes());
        bytes[length..length + SEAL].copy_from_slice(&seal.close(frame.bytes()));
        self.stream.write_all(&bytes[..length + SEAL])
    }

    fn close(&mut self) {
        self.stream.shut_down();
    }
}

/// Frames that come in.
pub(super) struct Receiver {
    stream: Stream,
    seal: Option<Seal>,
    /// Asked when nothing has come within the time that reading may take: whether that is too long.
    is_late: Box<dyn Fn() -> bool + Send>,
}

/// A stream that is read as long as its silence is not too long. What has come of a frame is not lost meanwhile.
struct Patient<'a> {
    stream: &'a mut Stream,
    is_late: &'a dyn Fn() -> bool,
}

impl Read for Patient<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        loop {
            match self.stream.read(bytes) {
                Err(error) if is_timeout(&error) && !(self.is_late)() => {}
                read => return read,
            }
        }
    }
}

impl Receiver {
    /// Frames without a seal, until there is one; any silence is too long.
    pub fn new(stream: Stream) -> Self {
        Self { stream, seal: None, is_late: Box::new(|| true) }
    }

    /// From here on frames have a seal.
    pub fn seal(&mut self, seal: Option<Seal>) {
        self.seal = seal;
    }

    /// From here on silence is too long if somebody says so, who is asked now and then.
    pub fn wait_until(&mut self, is_late: impl Fn() -> bool + Send + 'static) -> io::Result<()> {
        self.is_late = Box::new(is_late);
        self.stream.read_within(ROUND)
    }
}

impl Inlet for Receiver {
    fn receive(&mut self) -> Result<Frame, FrameError> {
        let mut stream = Patient { stream: &mut self.stream, is_late: &self.is_late };
        let frame = Frame::read(&mut stream)?;
        if let Some(seal) = &mut self.seal {
            let mut bytes = [0; SEAL];
            stream.read_exact(&mut bytes)?;
            seal.open(frame.bytes(), &bytes)?;
        }
        Ok(frame)
    }
}

/// True if nothing has come within the time that reading may take.
pub(super) fn is_timeout(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut)
}
