//! Errors of positions and frames: small `Copy` values with the expected and the actual value.

use core::fmt;

/// Errors of positions to send and of received bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Error {
    /// A coordinate that exceeds sixteen bits: the caller must not send it.
    OutOfRange {
        /// Axis: 0, 1, 2 for X, Y, Z.
        axis: usize,
        /// The coordinate, inches.
        inches: f64,
    },
    /// A position that is not a number.
    NotFinite,
    /// A period that is not a positive multiple of 10 ms up to 1000 ms (VI.1).
    BadPeriod {
        /// The period found, milliseconds.
        milliseconds: u16,
    },
    /// Too few or too many bytes for the frame.
    BadLength {
        /// Length of the frame.
        expected: usize,
        /// Number of bytes given.
        found: usize,
    },
    /// The frame begins with a wrong byte.
    BadHead {
        /// The first byte of a valid frame.
        expected: u8,
        /// The byte found.
        found: u8,
    },
    /// The checksum is wrong: the line has changed a byte.
    BadChecksum {
        /// The checksum of the bytes received.
        expected: u8,
        /// The checksum byte received.
        found: u8,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange { axis, inches } => {
                let name = ["X", "Y", "Z"].get(*axis).copied().unwrap_or("?");
                write!(f, "{name} of the end plate is {inches:.2} in, a word holds -327.68 to 327.67 in")
            }
            Self::NotFinite => f.write_str("not a position"),
            Self::BadPeriod { milliseconds } => {
                write!(f, "the period is a multiple of 10 ms from 10 to 1000, found {milliseconds} ms")
            }
            Self::BadLength { expected, found } => write!(f, "the frame has {expected} bytes, found {found}"),
            Self::BadHead { expected, found } => write!(f, "expected byte {expected:02X}, found {found:02X}"),
            Self::BadChecksum { expected, found } => {
                write!(f, "the checksum is {found:02X}, the bytes give {expected:02X}")
            }
        }
    }
}

impl core::error::Error for Error {}

#[cfg(test)]
mod tests {
    use super::Error;

    #[test]
    fn each_error_names_expected_and_actual_value() {
        for (error, words) in [
            (Error::OutOfRange { axis: 1, inches: 400.0 }, ["Y", "400.00", "327.67"]),
            (Error::NotFinite, ["not", "a", "position"]),
            (Error::BadPeriod { milliseconds: 1001 }, ["10 ms", "1000", "1001"]),
            (Error::BadLength { expected: 16, found: 15 }, ["frame", "16", "15"]),
            (Error::BadHead { expected: 1, found: 0xAB }, ["byte", "01", "AB"]),
            (Error::BadChecksum { expected: 0x73, found: 0xCD }, ["checksum", "73", "CD"]),
        ] {
            let text = error.to_string();
            assert!(words.iter().all(|word| text.contains(word)), "{text}");
        }
    }
}
