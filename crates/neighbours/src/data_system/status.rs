//! The status of the Data System.
//!
//! Task extracts the server status and the summary status from it (IX.2). The manual does not give its bytes.
//! CHOSEN, in the format of the command:
//!
//! ```text
//!   A1 82 00 0A   number of bytes that follow, high byte first
//!   B0 02 nn nn   command-id# of the answered command, low byte first
//!   51 01 ss      server status: 00 idle, 01 busy, 02 ready
//!   52 01 ss      summary status of that command: 00 none, 01 done, 80 to 84 refused, all in hexadecimal
//! ```

use std::fmt;

pub const STATUS: usize = 14; // length of a status, bytes
const SERVER: usize = 10;
const SUMMARY: usize = 13;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum ServerStatus {
    #[default]
    Idle = 0,
    Busy = 1,
    Ready = 2, // it has answered the last command
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Refusal {
    Protocol = 0x80,  // the bytes are not a command
    Sequence = 0x81,  // the command is not allowed in this state of the connection
    Statement = 0x82, // not a supported statement
    Value = 0x83,     // no item or place
    Store = 0x84,     // the database could not store the item
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Summary {
    #[default]
    None,
    Done,
    Refused(Refusal),
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Status {
    pub command_id: u16, // of the answered command
    pub server: ServerStatus,
    pub summary: Summary,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StatusError {
    #[error("a status of {STATUS} bytes was expected, found {0}")]
    Size(usize), // bytes
    #[error("byte {expected:02X} was expected at {at}, found {found:02X}")]
    Protocol {
        at: usize,    // offset, from 0
        expected: u8, // in the protocol
        found: u8,
    },
    #[error("a server status from 00 to 02 was expected at {SERVER}, found {0:02X}")]
    Server(u8),
    #[error("a summary status 00, 01 or 80 to 84 was expected at {SUMMARY}, found {0:02X}")]
    Summary(u8),
}

impl Refusal {
    const ALL: [Self; 5] = [Self::Protocol, Self::Sequence, Self::Statement, Self::Value, Self::Store];
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Protocol => "the bytes are not a command",
            Self::Sequence => "the connection is not in the state for this command",
            Self::Statement => "the statement is not known",
            Self::Value => "the statement names no item or no place",
            Self::Store => "the database cannot keep it",
        })
    }
}

impl Status {
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

    /// Parse-das-status. The error names the first wrong byte.
    pub fn decode(bytes: &[u8]) -> Result<Self, StatusError> {
        let bytes: &[u8; STATUS] = bytes.try_into().map_err(|_| StatusError::Size(bytes.len()))?;
        let blank = Self::default().encode();
        for at in [0, 1, 2, 3, 4, 5, 8, 9, 11, 12] {
            if bytes[at] != blank[at] {
                return Err(StatusError::Protocol { at, expected: blank[at], found: bytes[at] });
            }
        }
        let server = match bytes[SERVER] {
            0 => ServerStatus::Idle,
            1 => ServerStatus::Busy,
            2 => ServerStatus::Ready,
            found => return Err(StatusError::Server(found)),
        };
        let summary = match bytes[SUMMARY] {
            0 => Summary::None,
            1 => Summary::Done,
            found => Refusal::ALL
                .into_iter()
                .find(|&refusal| refusal as u8 == found)
                .map(Summary::Refused)
                .ok_or(StatusError::Summary(found))?,
        };
        Ok(Self { command_id: u16::from_le_bytes([bytes[6], bytes[7]]), server, summary })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encoded_status_decodes_to_itself() {
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
    fn every_wrong_status_byte_is_named() {
        let good = Status { command_id: 7, server: ServerStatus::Ready, summary: Summary::Done }.encode();
        let spoilt = |at: usize, byte: u8| {
            let mut bytes = good;
            bytes[at] = byte;
            Status::decode(&bytes)
        };
        for at in (0..STATUS).filter(|at| !(6..8).contains(at)) {
            let expected = match at {
                SERVER => StatusError::Server(0x7F),
                SUMMARY => StatusError::Summary(0x7F),
                _ => StatusError::Protocol { at, expected: good[at], found: 0x7F },
            };
            assert_eq!(spoilt(at, 0x7F), Err(expected));
        }
        let said = |result: Result<Status, StatusError>| result.unwrap_err().to_string();
        assert_eq!(said(spoilt(8, 0)), "byte 51 was expected at 8, found 00");
        assert_eq!(said(spoilt(SERVER, 9)), "a server status from 00 to 02 was expected at 10, found 09");
        let decimal = said(spoilt(SUMMARY, 80));
        assert_eq!(decimal, "a summary status 00, 01 or 80 to 84 was expected at 13, found 50");
        for size in [0, STATUS - 1, STATUS + 1] {
            let bytes = [0xA1; STATUS + 1];
            let text = format!("a status of 14 bytes was expected, found {size}");
            assert_eq!(said(Status::decode(&bytes[..size])), text);
        }
    }
}
