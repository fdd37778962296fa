//! Errors of frames: small, `Copy`, with the expected and the found value.

use core::fmt;

use crate::{
    Exception,
    mbap::{LEAST_LENGTH, MOST_LENGTH},
};

/// Why a frame is refused, or cannot be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error {
    /// The protocol identifier is not 0.
    BadProtocol {
        /// Identifier found.
        found: u16,
    },
    /// The length of the header is too short or too long for a frame.
    BadLength {
        /// Length found.
        found: u16,
    },
    /// The frame ends too early, or has bytes after its end.
    BadSize {
        /// Number of bytes expected.
        expected: usize,
        /// Number of bytes found.
        found: usize,
    },
    /// The answer belongs to another request.
    BadTransaction {
        /// Transaction identifier of the request.
        expected: u16,
        /// Transaction identifier of the answer.
        found: u16,
    },
    /// The answer is from another unit.
    BadUnit {
        /// Unit of the request.
        expected: u8,
        /// Unit of the answer.
        found: u8,
    },
    /// The answer is for another function.
    BadFunction {
        /// Function of the request.
        expected: u8,
        /// Function of the answer.
        found: u8,
    },
    /// The byte count does not match the quantity.
    BadByteCount {
        /// Byte count expected.
        expected: u8,
        /// Byte count found.
        found: u8,
    },
    /// The answer to a write request has another address, quantity or value than the request.
    BadEcho {
        /// Word of the request.
        expected: u16,
        /// Word of the answer.
        found: u16,
    },
    /// The quantity of a request is 0 or too great.
    BadQuantity {
        /// Greatest quantity of the function.
        most: u16,
        /// Quantity found.
        found: usize,
    },
    /// The addresses of a request end beyond 65535.
    BadAddress {
        /// First address.
        first: u16,
        /// Quantity.
        count: u16,
    },
    /// The value of a coil is neither on, FF00, nor off, 0000.
    BadCoil {
        /// Value found.
        found: u16,
    },
    /// A request has a function that this crate does not have.
    UnknownFunction {
        /// Function found.
        found: u8,
    },
    /// The server refused the request.
    Refused(Exception),
    /// The buffer is too small.
    NoRoom {
        /// Number of bytes needed.
        needed: usize,
    },
}

impl Error {
    /// True if the connection must be closed, because the next frame's position is unknown or the answer is to another
    /// request. False if only this request failed.
    #[must_use]
    pub const fn ends_connection(self) -> bool {
        match self {
            Self::BadProtocol { .. }
            | Self::BadLength { .. }
            | Self::BadSize { .. }
            | Self::BadTransaction { .. }
            | Self::BadUnit { .. }
            | Self::BadFunction { .. }
            | Self::BadByteCount { .. }
            | Self::BadEcho { .. } => true,
            Self::BadQuantity { .. }
            | Self::BadAddress { .. }
            | Self::BadCoil { .. }
            | Self::UnknownFunction { .. }
            | Self::Refused(_)
            | Self::NoRoom { .. } => false,
        }
    }

    /// A server's answer to a request with this error. A wrong length is also an illegal data value (AP 7).
    #[must_use]
    pub const fn exception(self) -> Exception {
        match self {
            Self::UnknownFunction { .. } => Exception::IllegalFunction,
            Self::BadAddress { .. } => Exception::IllegalDataAddress,
            Self::Refused(exception) => exception,
            Self::NoRoom { .. } => Exception::ServerDeviceFailure,
            _ => Exception::IllegalDataValue,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::BadProtocol { found } => {
                write!(f, "protocol identifier {found:#06x}, expected 0: this is not Modbus TCP")
            }
            Self::BadLength { found } => {
                write!(f, "length {found} in the header, expected {LEAST_LENGTH} to {MOST_LENGTH}")
            }
            Self::BadSize { expected, found } => write!(f, "{found} bytes, expected {expected}"),
            Self::BadTransaction { expected, found } => {
                write!(f, "transaction {found}, expected {expected}: a late answer, or another client's")
            }
            Self::BadUnit { expected, found } => {
                write!(f, "answer of unit {found}, expected unit {expected}")
            }
            Self::BadFunction { expected, found } => {
                write!(f, "answer to function {found}, expected function {expected}")
            }
            Self::BadByteCount { expected, found } => write!(f, "byte count {found}, expected {expected}"),
            Self::BadEcho { expected, found } => {
                write!(f, "the answer repeats {found:#06x}, expected {expected:#06x}")
            }
            Self::BadQuantity { most, found } => write!(f, "quantity {found}, expected 1 to {most}"),
            Self::BadAddress { first, count } => {
                write!(f, "{count} addresses from {first:#06x} end beyond 0xffff")
            }
            Self::BadCoil { found } => write!(f, "value {found:#06x} of a coil, expected 0xff00 or 0x0000"),
            Self::UnknownFunction { found } => {
                write!(f, "function {found}, expected one of 1 to 6, 15, 16, 23")
            }
            Self::Refused(exception) => exception.fmt(f),
            Self::NoRoom { needed } => write!(f, "the buffer is too small, {needed} bytes are needed"),
        }
    }
}

impl core::error::Error for Error {}
