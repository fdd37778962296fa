//! How a claim ends.

use std::{fmt, time::Duration};

pub const CLOSING: Duration = Duration::from_secs(1); // how long the end of a connection may take
/// Time for which a claim waits for the last sample after the token of the other side has disappeared.
pub const GRACE: Duration = Duration::from_millis(100);

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// The program at the socket has ended it, with its reason; empty if it has only closed the socket.
    Local(String),
    Network(String),   // the other end has ended it, with its reason; empty if it has none
    Violation(String), // the other end has broken the protocol
    Gone,              // the other end has gone without a word
    Silent,            // the other end was silent for too long
    Stopped,           // this process ends
}

impl fmt::Display for End {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Local(reason) | Self::Network(reason) if reason.is_empty() => {
                f.write_str("the connection was closed")
            }
            Self::Local(reason) | Self::Network(reason) | Self::Violation(reason) => f.write_str(reason),
            Self::Gone => f.write_str("the other end has gone: killed, or the line is cut"),
            Self::Silent => f.write_str("nothing was received for 10 s"),
            Self::Stopped => f.write_str("this gateway ends"),
        }
    }
}
