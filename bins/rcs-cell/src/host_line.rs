//! The pseudo-terminal with the serial line in time behind it: what a DEPC host is connected to.

use std::os::fd::BorrowedFd;

use interfaces::device::LinkBytes;
use os_io::stdout_line;

use crate::{
    line::SerialLine,
    pty::{Pty, PtyError},
};

/// Baud of the link (VI.1).
const BAUD: u32 = 9600;

/// The line to a host. Times are microseconds of one monotonic clock.
pub struct HostLine {
    pty: Pty,
    host: bool,
    line: SerialLine,
}

impl HostLine {
    /// A line without a host.
    #[must_use]
    pub fn new(pty: Pty) -> Self {
        stdout_line!("[link] {} waits for a host", pty.slave().display());
        Self { pty, host: false, line: SerialLine::new(BAUD) }
    }

    /// A host has the terminal open: that stands for its DTR.
    #[must_use]
    pub const fn has_host(&self) -> bool {
        self.host
    }

    /// The line in time.
    #[must_use]
    pub const fn line(&self) -> &SerialLine {
        &self.line
    }

    /// What is to be waited for: without a host the master reports a hang-up all the time, and a full line has
    /// no room for what is there.
    #[must_use]
    pub fn readable(&self) -> Option<BorrowedFd<'_>> {
        (self.host && self.line.room() > 0).then(|| self.pty.fd())
    }

    /// Has a host come or gone? Then take what it has sent.
    ///
    /// # Errors
    /// [`PtyError`].
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

    /// What has arrived from the host.
    pub fn arrived(&mut self, now: u64) -> LinkBytes {
        self.line.arrived(now)
    }

    /// Put bytes on the line, if a host is there.
    pub fn send(&mut self, now: u64, bytes: &[u8]) {
        if self.host {
            self.line.send(now, bytes);
        }
    }

    /// Hand over the bytes that have reached the host.
    ///
    /// # Errors
    /// [`PtyError`].
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
