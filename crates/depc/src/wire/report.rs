//! The report of the controller: the position of the robot (A 2.3).
//!
//! ```text
//!  0    1    2    3 4  5 6  7 8  9 10  11 12  13 14  15
//!  FF   FF   03   X    Y    Z    D     E      R      checksum
//! ```

use super::{FILL, FRAME_BYTES, START, checksum};
use crate::{Error, Plate};

/// The controller's report at start and restart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Present position of the end plate.
    pub plate: Plate,
}

impl Report {
    /// The first three bytes of a report.
    pub const HEAD: [u8; 3] = [FILL, FILL, START];

    /// Write the frame into `bytes`.
    pub fn emit(&self, bytes: &mut [u8; FRAME_BYTES]) {
        let (head, rest) = bytes.split_at_mut(Self::HEAD.len());
        head.copy_from_slice(&Self::HEAD);
        if let Some((position, sum)) = rest.split_first_chunk_mut::<12>() {
            *position = self.plate.to_bytes();
            sum.fill(checksum(&Self::HEAD) ^ checksum(position));
        }
    }

    /// Parses the bytes. Errors: [`Error::BadLength`], [`Error::BadHead`], [`Error::BadChecksum`].
    pub fn parse(bytes: &[u8]) -> Result<Self, Error> {
        let frame = <&[u8; FRAME_BYTES]>::try_from(bytes)
            .map_err(|_| Error::BadLength { expected: FRAME_BYTES, found: bytes.len() })?;
        let [a, b, c, position @ .., sum] = frame;
        for (expected, found) in Self::HEAD.into_iter().zip([*a, *b, *c]) {
            if expected != found {
                return Err(Error::BadHead { expected, found });
            }
        }
        let expected = checksum(&Self::HEAD) ^ checksum(position);
        if expected == *sum {
            Ok(Self { plate: Plate::from_bytes(position) })
        } else {
            Err(Error::BadChecksum { expected, found: *sum })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOME: [u8; 16] =
        [0xFF, 0xFF, 0x03, 0, 0, 0xE7, 0x68, 0xFD, 0x85, 0xDC, 0xD8, 0x34, 0xB7, 0, 0, 0x73];

    #[test]
    fn writes_every_byte() {
        let mut bytes = [0xA5; 16];
        Report { plate: Plate { words: [0, -6296, -635, -9000, 13495, 0] } }.emit(&mut bytes);
        assert_eq!(bytes, HOME);
    }

    #[test]
    fn written_frame_is_read_back() {
        assert_eq!(Report::parse(&HOME).unwrap().plate.words, [0, -6296, -635, -9000, 13495, 0]);
    }

    #[test]
    fn refuses_wrong_bytes() {
        assert_eq!(Report::parse(&HOME[..15]), Err(Error::BadLength { expected: 16, found: 15 }));
        assert_eq!(Report::parse(&[0; 17]), Err(Error::BadLength { expected: 16, found: 17 }));
        let mut bytes = HOME;
        bytes[1] = 0xFE;
        assert_eq!(Report::parse(&bytes), Err(Error::BadHead { expected: 0xFF, found: 0xFE }));
    }

    #[test]
    fn every_single_flipped_bit_after_the_head_shows() {
        for place in 3..16 {
            for bit in 0..8 {
                let mut bytes = HOME;
                bytes[place] ^= 1 << bit;
                assert!(
                    matches!(Report::parse(&bytes), Err(Error::BadChecksum { .. })),
                    "byte {place} bit {bit}"
                );
            }
        }
    }
}
