//! The bytes of a tick on the line, the faults of the link, and its counters.

use rcs_core::Plain;

/// Bytes per direction and tick: 9600 baud give 38, and queued bytes in a receiver need room.
pub const LINK_BYTES: usize = 64;

/// Bytes of one tick on a serial line.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct LinkBytes {
    /// Number of valid bytes.
    pub length: u8,
    /// The bytes, zero after `length`.
    pub bytes: [u8; LINK_BYTES],
}

impl LinkBytes {
    /// The valid bytes.
    #[must_use]
    pub fn as_slice(&self) -> &[u8] {
        self.bytes.get(..usize::from(self.length)).unwrap_or(&self.bytes)
    }

    /// Append a byte; false if it does not fit.
    pub fn push(&mut self, byte: u8) -> bool {
        match self.bytes.get_mut(usize::from(self.length)) {
            Some(slot) => {
                *slot = byte;
                self.length = self.length.saturating_add(1);
                true
            }
            None => false,
        }
    }

    /// Append as many of `bytes` as fit. Returns their number.
    pub fn extend(&mut self, bytes: &[u8]) -> usize {
        bytes.iter().take_while(|&&byte| self.push(byte)).count()
    }
}

/// `status-arg-out` of T3I; the code is the manual's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum LinkFault {
    /// 0: no error.
    #[text = "no error"]
    None,
    /// 1: the DEPC link is not responding.
    #[text = "not responding"]
    NotResponding,
    /// 2: DEPC detected an error.
    #[text = "DEPC detected an error"]
    DepcError,
    /// 3: a message from DEPC contained a checksum error.
    #[text = "checksum error"]
    Checksum,
    /// 4: the message to DEPC was not transmitted.
    #[text = "not transmitted"]
    NotTransmitted,
    /// 5: an invalid command has been sent.
    #[text = "invalid command"]
    InvalidCommand,
}

/// Counters of the link since the start (extension).
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct LinkCounters {
    /// Data commands sent, including repetitions.
    pub frames: u32,
    /// Data commands acknowledged.
    pub acknowledged: u32,
    /// NAKs received.
    pub naks: u32,
    /// Data commands sent again after a NAK.
    pub retries: u32,
    /// Frames without an answer in time.
    pub timeouts: u32,
    /// Restart commands sent.
    pub restarts: u32,
    /// Reports received with an incorrect checksum.
    pub checksum_errors: u32,
    /// Points that were scaled back to the velocity limits.
    pub limited: u32,
}
