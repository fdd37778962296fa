//! The status of the Data System.
//!
//! Task extracts from it the server status and the summary status (IX.2); how its bytes stand is not in the manual. CHOSEN,
//! in the manner of the command:
//!
//! ```text
//!   A1 82 00 0A   what follows
//!   B0 02 nn nn   command-id# that is answered, low byte first
//!   51 01 ss      server status: 0 idle, 1 busy, 2 ready
//!   52 01 ss      summary status of that command: 0 none, 1 done, 80 and more refused
//! ```

use std::fmt;

/// Bytes of a status.
pub const STATUS: usize = 14;

/// What the server is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum ServerStatus {
    /// No command was given yet.
    #[default]
    Idle = 0,
    /// It executes a command.
    Busy = 1,
    /// It has answered the last one.
    Ready = 2,
}

/// Why a command was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Refusal {
    /// The bytes are no command.
    Protocol = 0x80,
    /// The connection is not far enough for it, or farther.
    Sequence = 0x81,
    /// The string is no statement that this server knows.
    Statement = 0x82,
    /// The statement names no item or no place.
    Value = 0x83,
    /// The data base could not keep it.
    Store = 0x84,
}

/// What became of the command that is answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Summary {
    /// Nothing yet.
    #[default]
    None,
    /// It is done.
    Done,
    /// It was refused.
    Refused(Refusal),
}

/// A status.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Status {
    /// command-id# that is answered.
    pub command_id: u16,
    /// What the server is doing.
    pub server: ServerStatus,
    /// What became of the command.
    pub summary: Summary,
}

/// Why bytes are no status.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a status of the Data System was expected, found {found:02X} at {at}")]
pub struct StatusError {
    /// Where the first byte that cannot be stands, from 0; [`STATUS`] if there are more or less bytes.
    pub at: usize,
    /// That byte, or 0.
    pub found: u8,
}

impl Refusal {
    const ALL: [Self; 5] = [Self::Protocol, Self::Sequence, Self::Statement, Self::Value, Self::Store];
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Protocol => "the bytes are no command",
            Self::Sequence => "the connection is in another state",
            Self::Statement => "the statement is not known",
            Self::Value => "the statement names no item or no place",
            Self::Store => "the data base cannot keep it",
        })
    }
}

impl Status {
    /// The bytes.
    #[must_use]
    pub fn encode(&self) -> [u8; STATUS] {
        let [low, high] = self.command_id.to_le_bytes();
        let summary = match self.summary {
            Summary::None => 0,
            Summary::Done => 1,
            Summary::Refused(refusal) => refusal as u8,
        };
        [0xA1, 0x82, 0, 0x0A, 0xB0, 2, low, high, 0x51, 1, self.server as u8, 0x52, 1, summary]
    }

    /// Read the bytes: Parse-das-status.
    ///
    /// # Errors
    /// [`StatusError`] with the first byte that cannot be.
    pub fn decode(bytes: &[u8]) -> Result<Self, StatusError> {
        let Ok(bytes) = <&[u8; STATUS]>::try_from(bytes) else {
            return Err(StatusError { at: STATUS, found: 0 });
        };
        let blank = Self::default().encode();
        for at in [0, 1, 2, 3, 4, 5, 8, 9, 11, 12] {
            if bytes[at] != blank[at] {
                return Err(StatusError { at, found: bytes[at] });
            }
        }
        let server = match bytes[10] {
            0 => ServerStatus::Idle,
            1 => ServerStatus::Busy,
            2 => ServerStatus::Ready,
            found => return Err(StatusError { at: 10, found }),
        };
        let summary = match bytes[13] {
            0 => Summary::None,
            1 => Summary::Done,
            found => Refusal::ALL
                .into_iter()
                .find(|&refusal| refusal as u8 == found)
                .map(Summary::Refused)
                .ok_or(StatusError { at: 13, found })?,
        };
        Ok(Self { command_id: u16::from_le_bytes([bytes[6], bytes[7]]), server, summary })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let summaries =
            [Summary::None, Summary::Done].into_iter().chain(Refusal::ALL.into_iter().map(Summary::Refused));
        for summary in summaries {
            for server in [ServerStatus::Idle, ServerStatus::Busy, ServerStatus::Ready] {
                let status = Status { command_id: 0x1234, server, summary };
                assert_eq!(Status::decode(&status.encode()), Ok(status));
            }
        }
    }

    #[test]
    fn every_byte_that_cannot_be_is_named() {
        let good = Status { command_id: 7, server: ServerStatus::Ready, summary: Summary::Done }.encode();
        for at in (0..STATUS).filter(|at| !(6..8).contains(at)) {
            let mut bytes = good;
            bytes[at] = 0x7F;
            assert_eq!(Status::decode(&bytes), Err(StatusError { at, found: 0x7F }));
        }
        assert_eq!(Status::decode(&good[..13]), Err(StatusError { at: STATUS, found: 0 }));
    }
}
