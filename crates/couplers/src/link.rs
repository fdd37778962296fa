//! The connection that a session needs, and its faults.

use std::fmt;

use modbus::{Error, MOST_FRAME_BYTES, Request, Response};
use rcs_core::Plain;

/// A connection to a device, with one request at a time.
pub trait Link {
    /// The time, ns of one monotonic clock.
    fn now(&mut self) -> u64;

    /// Connects. Fails if the device does not accept the connection in time.
    fn connect(&mut self) -> Result<(), Fault>;

    /// Sends a request and waits for its answer, with a limit. If an earlier request is unanswered, it first waits for
    /// that answer and discards it, so that at most one request is pending.
    fn exchange<'a>(
        &mut self,
        request: &Request<'_>,
        buffer: &'a mut [u8; MOST_FRAME_BYTES],
    ) -> Result<Response<'a>, Fault>;

    /// Ends the connection at once: data that have not left this machine are dropped.
    fn reset(&mut self);
}

/// A fault of a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Fault {
    /// The device has not answered in time.
    NoAnswer,
    /// The device has still not answered an earlier request; no further one was sent.
    Unanswered,
    /// The device does not accept a connection.
    NoConnection,
    /// The connection has ended.
    Disconnected,
    /// The device refused the request with this exception code.
    Exception(u8),
    /// The bytes are not an answer to the request.
    Frame(FrameFault),
}

/// The wrong part of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum FrameFault {
    /// Protocol identifier.
    Protocol,
    /// Length.
    Length,
    /// Transaction identifier: the answer belongs to another request.
    Transaction,
    /// Unit.
    Unit,
    /// Function.
    Function,
    /// Address, quantity or value that an answer repeats.
    Echo,
    /// The request itself: it was not sent.
    Request,
}

impl Fault {
    /// True if the connection must be closed. False if a later request may succeed.
    #[must_use]
    pub const fn ends_connection(self) -> bool {
        match self {
            Self::NoAnswer | Self::Unanswered | Self::Exception(_) => false,
            Self::NoConnection | Self::Disconnected | Self::Frame(_) => true,
        }
    }
}

/// The end of a sentence about the device: `it does not answer`.
impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoAnswer | Self::Unanswered => "it does not answer",
            Self::NoConnection => "it does not accept a connection",
            Self::Disconnected => "it has ended the connection",
            Self::Exception(code) => return write!(f, "it refuses a request with exception {code}"),
            Self::Frame(part) => return write!(f, "its answer is wrong in the {}", part.text()),
        })
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        Self::Frame(match error {
            Error::Refused(exception) => return Self::Exception(exception.code()),
            Error::BadProtocol { .. } => FrameFault::Protocol,
            Error::BadLength { .. } | Error::BadSize { .. } | Error::BadByteCount { .. } => {
                FrameFault::Length
            }
            Error::BadTransaction { .. } => FrameFault::Transaction,
            Error::BadUnit { .. } => FrameFault::Unit,
            Error::BadFunction { .. } => FrameFault::Function,
            Error::BadEcho { .. } => FrameFault::Echo,
            Error::BadQuantity { .. }
            | Error::BadAddress { .. }
            | Error::BadCoil { .. }
            | Error::UnknownFunction { .. }
            | Error::NoRoom { .. } => FrameFault::Request,
        })
    }
}
