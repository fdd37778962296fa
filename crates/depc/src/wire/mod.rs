//! The frames of appendix A 2.3, one per file; all numbers in them are hexadecimal.
//!
//! | from | frame | bytes |
//! |---|---|---|
//! | controller | [`Report`] | `FF FF 03`, 12 of position, checksum |
//! | host | [`DataCommand`] | `03`, 2 of function, 12 of position, checksum |
//! | host | [`Control`] | `18` cancel, `05` restart; no checksum |
//! | controller | [`Response`] | `06` ACK, `15` NAK; no checksum |

mod control;
mod data;
mod report;

pub use control::{Control, Response};
pub use data::{DataCommand, NO_FUNCTION};
pub use report::Report;

/// Length of a report and of a data command, bytes.
pub const FRAME_BYTES: usize = 16;

/// First byte of a data command, third of a report (A 2.3).
pub const START: u8 = 0x03;
/// First two bytes of a report (A 2.3).
pub const FILL: u8 = 0xFF;

/// The checksum: exclusive or of all bytes, starting with zero (A 2.3). Over a frame with its checksum it is zero.
#[must_use]
pub fn checksum(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum, byte| sum ^ byte)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_of_no_bytes_is_zero_and_excludes_the_fill_bytes() {
        assert_eq!(checksum(&[]), 0);
        assert_eq!(checksum(&[0xFF, 0xFF, 0x03]), checksum(&[0x03]));
        assert_eq!(checksum(&[0x03, 0xE7, 0x68, 0xFD, 0x85, 0xDC, 0xD8, 0x34, 0xB7]), 0x73);
    }
}
