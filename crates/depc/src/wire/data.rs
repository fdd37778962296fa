//! The data command of the host: move to a position, and run a function on arrival (A 2.3, A 2.5).
//!
//! ```text
//!  0    1 2        3 4  5 6  7 8  9 10  11 12  13 14  15
//!  03   function   X    Y    Z    D     E      R      checksum
//! ```

use super::{FRAME_BYTES, START, checksum};
use crate::{Error, Plate};

/// Function bytes for no function (ASSUMED: the meaning of "bytes two and three of the Point Data" is not known).
pub const NO_FUNCTION: [u8; 2] = [0, 0];

/// The host's command for the next period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DataCommand {
    /// Function to run at the position; [`NO_FUNCTION`] for none.
    pub function: [u8; 2],
    /// The commanded position.
    pub plate: Plate,
}

impl DataCommand {
    /// Write the frame into `bytes`.
    pub fn emit(&self, bytes: &mut [u8; FRAME_BYTES]) {
        let [start, function @ .., _, _, _, _, _, _, _, _, _, _, _, _, _] = bytes;
        *start = START;
        *function = self.function;
        let position = self.plate.to_bytes();
        let (_, rest) = bytes.split_at_mut(3);
        if let Some((place, sum)) = rest.split_first_chunk_mut::<12>() {
            *place = position;
            sum.fill(START ^ checksum(&self.function) ^ checksum(&position));
        }
    }

    /// Parses the bytes. Errors: [`Error::BadLength`], [`Error::BadHead`], [`Error::BadChecksum`].
    pub fn parse(bytes: &[u8]) -> Result<Self, Error> {
        let frame = <&[u8; FRAME_BYTES]>::try_from(bytes)
            .map_err(|_| Error::BadLength { expected: FRAME_BYTES, found: bytes.len() })?;
        let [start, first, second, position @ .., sum] = frame;
        if *start != START {
            return Err(Error::BadHead { expected: START, found: *start });
        }
        let function = [*first, *second];
        let expected = START ^ checksum(&function) ^ checksum(position);
        if expected == *sum {
            Ok(Self { function, plate: Plate::from_bytes(position) })
        } else {
            Err(Error::BadChecksum { expected, found: *sum })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOME: [u8; 16] = [0x03, 0, 0, 0, 0, 0xE7, 0x68, 0xFD, 0x85, 0xDC, 0xD8, 0x34, 0xB7, 0, 0, 0x73];
    const PLATE: Plate = Plate { words: [0, -6296, -635, -9000, 13495, 0] };

    #[test]
    fn writes_every_byte() {
        let mut bytes = [0xA5; 16];
        DataCommand { function: NO_FUNCTION, plate: PLATE }.emit(&mut bytes);
        assert_eq!(bytes, HOME);
        DataCommand { function: [0x12, 0x34], plate: PLATE }.emit(&mut bytes);
        assert_eq!(bytes[..4], [0x03, 0x12, 0x34, 0]);
        assert_eq!(bytes[15], 0x73 ^ 0x12 ^ 0x34);
    }

    #[test]
    fn written_frame_is_read_back() {
        assert_eq!(DataCommand::parse(&HOME), Ok(DataCommand { function: NO_FUNCTION, plate: PLATE }));
    }

    #[test]
    fn refuses_wrong_bytes() {
        assert_eq!(DataCommand::parse(&[]), Err(Error::BadLength { expected: 16, found: 0 }));
        let mut bytes = HOME;
        bytes[0] = 0x05;
        assert_eq!(DataCommand::parse(&bytes), Err(Error::BadHead { expected: 0x03, found: 0x05 }));
        bytes = HOME;
        bytes[15] = 0x72;
        assert_eq!(DataCommand::parse(&bytes), Err(Error::BadChecksum { expected: 0x73, found: 0x72 }));
    }
}
