//! The port for a DEPC host: a pseudo-terminal with a simulated serial line.

use std::os::fd::BorrowedFd;

use interfaces::device::LinkBytes;
use os_io::stdout_line;

use crate::{
    line::SerialLine,
    pty::{Pty, PtyError},
};

const BAUD: u32 = 9600; // baud rate of the link (VI.1)

/// The line to a host. Times are us of one monotonic clock.
pub struct HostLine {
    pty: Pty,
    host: bool,
    line: SerialLine,
}

impl HostLine {
    #[must_use]
    pub fn new(pty: Pty) -> Self {
        stdout_line!("[link] {} waits for a host", pty.slave().display());
        Self { pty, host: false, line: SerialLine::new(BAUD) }
    }

    /// True if a host has the terminal open, which stands for the host's DTR.
    #[must_use]
    pub const fn has_host(&self) -> bool {
        self.host
    }

    #[must_use]
    pub const fn line(&self) -> &SerialLine {
        &self.line
    }

    /// The file descriptor to wait for. `None` if the line is full or no host is connected, which would poll as a
    /// hang-up.
    #[must_use]
    pub fn readable(&self) -> Option<BorrowedFd<'_>> {
        (self.host && self.line.room() > 0).then(|| self.pty.fd())
    }

    /// Checks whether a host has opened or closed the terminal, and reads its bytes.
    pub fn poll(&mut self, now: u64) -> Result<(), PtyError> {
        let host = self.pty.has_host();
        if host != self.host {
            self.host = host;
            self.tell()?;
        }
        let mut bytes = [0; 256];
        let room = self.line.room().min(bytes.len());
        if self.host && room > 0 {
            let count = self.pty.read(&mut bytes[..room])?;
            self.line.host_sent(now, &bytes[..count]);
        }
        Ok(())
    }

    /// Takes the bytes of the host that have arrived by `now`, us.
    pub fn arrived(&mut self, now: u64) -> LinkBytes {
        self.line.arrived(now)
    }

    /// Puts bytes on the line if a host is connected.
    pub fn send(&mut self, now: u64, bytes: &[u8]) {
        if self.host {
            self.line.send(now, bytes);
        }
    }

    /// Writes the bytes that have passed the line by `now`, us, to the terminal.
    pub fn deliver(&mut self, now: u64) -> Result<(), PtyError> {
        while let Some(byte) = self.line.delivered(now) {
            self.pty.write(byte)?;
        }
        Ok(())
    }

    fn tell(&mut self) -> Result<(), PtyError> {
        if self.host {
            stdout_line!("[link] a host has opened the link");
            return Ok(());
        }
        self.line.clear();
        if self.pty.renew()? {
            stdout_line!("[link] the host has left it locked, now at {}", self.pty.slave().display());
        } else {
            stdout_line!("[link] the host has closed the link");
        }
        Ok(())
    }
}
