//! A serial port for the controller: bytes are received and sent without waiting (docs/design/link.md "Serial port").
//!
//! In a tick [`SerialLine`] makes a handful of system calls, never blocks and never allocates. The port may disappear
//! at any time: then the line is not ready and gives no bytes; this is not an error. A helper thread closes the dead
//! port (closing may wait for the hardware) and tries once per second to open it again.
//!
//! ```text
//!  tick thread                                helper thread
//!  receive, send ── port is gone ── dead ──►  close it; once a second: open ──► opened
//!       ▲                                                                         │
//!       └─────────────────── taken over at the next tick ─────────────────────────┘
//! ```
//!
//! There are two descriptors of the port. The serialport crate sets the line up and reads the modem lines, but it
//! blocks and allocates; bytes go through the other one.

mod settings;

use std::{
    fs::File,
    io::{self, ErrorKind, Read as _, Write as _},
    path::{Path, PathBuf},
    sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    thread,
    time::Duration,
};

use interfaces::device::LinkBytes;
use rustix::{
    event::{PollFd, PollFlags, Timespec, poll},
    fs::{Mode, OFlags},
    io::{Errno, ioctl_fionread},
};
use serialport::{ClearBuffer, SerialPort as _, TTYPort};

pub use self::settings::{Parity, SerialSettings};

/// Time between two attempts to open a port that has disappeared.
pub const RETRY: Duration = Duration::from_secs(1);

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OpenError {
    #[error("there is no serial port {}", .0.display())]
    Missing(PathBuf),
    #[error("{}: permission denied; ports usually belong to a group such as dialout", .0.display())]
    Denied(PathBuf),
    #[error("{} is used by another program", .0.display())]
    Busy(PathBuf),
    /// It is not a serial port, or does not support the settings.
    #[error("{} cannot be used as a serial port: {reason}", path.display())]
    Unusable {
        path: PathBuf,
        reason: String, // the error of the operating system
    },
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SerialCounts {
    pub received: u64,
    pub sent: u64,
    /// Bytes that the port did not take, or that were sent while there was no port.
    pub unsent: u64,
    pub losses: u32, // times that the port has disappeared
    /// Number of times that it was opened again.
    pub reopened: u32,
}

#[derive(Debug)]
pub struct SerialLine {
    path: PathBuf,
    port: Option<Port>,
    cut: bool,    // the port took only a part of a frame; the line is not ready for a tick
    unsent: bool, // not all bytes of the last tick were sent
    counts: SerialCounts,
    dead: SyncSender<Port>,
    opened: Receiver<Port>,
}

struct PortLost;

impl SerialLine {
    /// Open a port. The thread that keeps it open has the caller's priority: open it before the real-time requests.
    pub fn open(settings: SerialSettings) -> Result<Self, OpenError> {
        let port = Port::open(&settings)?;
        let (dead, to_close) = sync_channel(1);
        let (hand_over, opened) = sync_channel(1);
        let path = settings.path.clone();
        let unusable =
            |error: io::Error| OpenError::Unusable { path: path.clone(), reason: error.to_string() };
        thread::Builder::new()
            .name("serial-port".into())
            .spawn(move || keep_open(&settings, &to_close, &hand_over))
            .map_err(unusable)?;
        Ok(Self {
            path,
            port: Some(port),
            cut: false,
            unsent: false,
            counts: SerialCounts::default(),
            dead,
            opened,
        })
    }

    /// Append received bytes to `rx`, as far as there is room. True if the port is there and, if it has modem lines,
    /// CTS is on (the robot's DTR, A.2). Never blocks, never allocates.
    pub fn receive(&mut self, rx: &mut LinkBytes) -> bool {
        if self.port.is_none()
            && let Ok(port) = self.opened.try_recv()
        {
            self.port = Some(port);
            self.counts.reopened = self.counts.reopened.saturating_add(1);
        }
        let before = rx.length;
        let ready = match self.port.as_mut().map(|port| port.receive(rx)) {
            Some(Ok(ready)) => ready && !std::mem::take(&mut self.cut),
            Some(Err(PortLost)) => {
                self.lose();
                false
            }
            None => false,
        };
        if self.port.is_none() {
            *rx = LinkBytes::default();
        } else {
            self.counts.received += u64::from(rx.length - before);
        }
        ready
    }

    /// Send the bytes of a tick; true if the port took them all. A port that takes only a part is stuck: the rest is
    /// dropped and counted, and the line is not ready in the next tick, so that the link restarts. Never blocks, never
    /// allocates.
    pub fn send(&mut self, tx: &LinkBytes) -> bool {
        let bytes = tx.as_slice();
        if bytes.is_empty() {
            self.unsent = false;
            return true;
        }
        let taken = match self.port.as_mut().map(|port| port.send(bytes)) {
            Some(Ok(taken)) => taken,
            Some(Err(PortLost)) => {
                self.lose();
                0
            }
            None => 0,
        };
        self.counts.sent += taken as u64;
        self.counts.unsent += (bytes.len() - taken) as u64;
        self.unsent = taken < bytes.len();
        self.cut = self.port.is_some() && self.unsent;
        !self.unsent
    }

    /// True if the port did not take all bytes: `link_unsent` of [`interfaces::DeviceInputs`].
    #[must_use]
    pub const fn has_unsent(&self) -> bool {
        self.unsent
    }

    /// Wait for bytes for up to `timeout`; may return early. Not for use in a tick.
    pub fn wait(&self, timeout: Duration) {
        let (Some(port), Ok(limit)) = (&self.port, Timespec::try_from(timeout)) else {
            return thread::sleep(timeout);
        };
        let _ = poll(&mut [PollFd::new(&port.bytes, PollFlags::IN)], Some(&limit));
    }

    /// True if the port is there and, if it has modem lines, CTS is on. Reads no bytes.
    pub fn is_ready(&mut self) -> bool {
        self.port.as_mut().is_some_and(Port::is_ready)
    }

    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// True while there is a port.
    #[must_use]
    pub const fn is_there(&self) -> bool {
        self.port.is_some()
    }

    /// True if the port has modem lines; a pseudo-terminal has none, and is ready while it exists.
    #[must_use]
    pub fn has_modem_lines(&self) -> bool {
        self.port.as_ref().is_some_and(|port| port.modem)
    }

    #[must_use]
    pub const fn counts(&self) -> SerialCounts {
        self.counts
    }

    fn lose(&mut self) {
        if let Some(port) = self.port.take() {
            self.counts.losses = self.counts.losses.saturating_add(1);
            drop(self.dead.try_send(port));
        }
    }
}

/// The helper thread: closes dead ports and opens them again, until the line is dropped.
fn keep_open(settings: &SerialSettings, dead: &Receiver<Port>, hand_over: &SyncSender<Port>) {
    while let Ok(port) = dead.recv() {
        drop(port);
        let port = loop {
            match dead.recv_timeout(RETRY) {
                Err(RecvTimeoutError::Timeout) => {}
                _ => return,
            }
            if let Ok(port) = Port::open(settings) {
                break port;
            }
        };
        if hand_over.send(port).is_err() {
            return;
        }
    }
}

#[derive(Debug)]
struct Port {
    bytes: File,    // descriptor for bytes; does not block
    lines: TTYPort, // descriptor for set-up, exclusive use and modem lines
    modem: bool,
}

impl Port {
    fn open(settings: &SerialSettings) -> Result<Self, OpenError> {
        let path = &settings.path;
        let unusable = |reason: String| OpenError::Unusable { path: path.clone(), reason };
        // Ctrl-C on the terminal must not end the program.
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::NONBLOCK | OFlags::CLOEXEC;
        let bytes = rustix::fs::open(path, flags, Mode::empty()).map_err(|error| match error {
            Errno::NOENT | Errno::NODEV | Errno::NXIO => OpenError::Missing(path.clone()),
            Errno::ACCESS | Errno::PERM => OpenError::Denied(path.clone()),
            Errno::BUSY => OpenError::Busy(path.clone()),
            other => unusable(io::Error::from(other).to_string()),
        })?;
        if !rustix::termios::isatty(&bytes) {
            return Err(unusable("it is not a terminal device".into()));
        }
        let name = path.to_str().ok_or_else(|| unusable("its name is not UTF-8".into()))?;
        let mut lines = TTYPort::open(&settings.builder(name)).map_err(|error| match error.kind {
            serialport::ErrorKind::NoDevice => OpenError::Busy(path.clone()),
            _ => unusable(error.description),
        })?;
        // Discard old bytes, which have no meaning any more. A port without this function has none to discard.
        drop(lines.clear(ClearBuffer::All));
        let modem = settings.clear_to_send && lines.read_clear_to_send().is_ok();
        Ok(Self { bytes: File::from(bytes), lines, modem })
    }

    fn is_ready(&mut self) -> bool {
        !self.modem || self.lines.read_clear_to_send().unwrap_or(false)
    }

    fn receive(&mut self, rx: &mut LinkBytes) -> Result<bool, PortLost> {
        let room = rx.bytes.get_mut(usize::from(rx.length)..).unwrap_or_default();
        // A read that finds nothing waits for the kernel's worker, up to half a second on a busy machine. Bytes that
        // the worker has not delivered have not arrived.
        let arrived = ioctl_fionread(&self.bytes).map_err(|_| PortLost)?;
        if arrived > 0 && !room.is_empty() {
            match self.bytes.read(room) {
                Ok(0) => return Err(PortLost),
                Ok(count) => rx.length += u8::try_from(count).unwrap_or_default(),
                Err(error) if waits(error.kind()) => {}
                Err(_) => return Err(PortLost),
            }
        }
        if self.modem { self.lines.read_clear_to_send().map_err(|_| PortLost) } else { Ok(true) }
    }

    fn send(&mut self, bytes: &[u8]) -> Result<usize, PortLost> {
        let taken = match self.bytes.write(bytes) {
            Ok(count) => count,
            Err(error) if waits(error.kind()) => 0,
            Err(_) => return Err(PortLost),
        };
        if taken < bytes.len() {
            self.lines.clear(ClearBuffer::Output).map_err(|_| PortLost)?;
        }
        Ok(taken)
    }
}

/// True if the error only means that there are no bytes to read, or no room to write, at the moment.
fn waits(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::WouldBlock | ErrorKind::Interrupted)
}
