//! What vision writes, byte by byte (IX.4): the two ready words and the response. CHOSEN, Figure IX.3 is lost.
//!
//! ```text
//!   at  bytes  variable              holds
//!    0    2    vision-ready-input    2 ready: the response may be read; 1 not ready
//!    2    2    vision-ready-output   2 ready: a request may be written; 1 not ready
//!    4    2    response-byte-count   bytes of the response area behind it, 12
//!    6    2    request-#-echo        request that is answered, 0 for none
//!    8    2    status                0 none; 1 busy; 2 done: the values are valid; 3 nothing seen; 4 not recognised
//!   10    2    y                     centroid from the optical axis along the tool's Y, 0.01 in, signed
//!   12    2    z                     centroid along X x Y, where X is the optical axis away from the camera, 0.01 in, signed
//!   14    2    angle                 right-hand roll about X that brings Y onto the dimension to grip across, 0.01 degree,
//!                                    signed, -9000 to 9000
//!   16    2    recognised            object-id of what was recognised, 0 for none
//! ```

use rcs_core::interface::device::{VisionResponse, VisionStatus};

use super::VisionError;
use crate::fields::{FieldError, Packer, RangeError, Unpacker, command_number};

/// Bytes of the data of a response mailbox.
pub const AREAS: usize = 18;
/// `response-byte-count`.
const AREA: usize = AREAS - 6;

/// A ready word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Ready {
    /// The area is not to be touched (CHOSEN: the manual gives no number).
    NotReady = 1,
    /// It may be read, or written (IX.4).
    Ready = 2,
}

impl Ready {
    fn from_word(field: &'static str, found: u16) -> Result<Self, VisionError> {
        [Self::NotReady, Self::Ready]
            .into_iter()
            .find(|&ready| ready as u16 == found)
            .ok_or(VisionError::Ready { field, found })
    }
}

/// The areas that vision writes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Areas {
    /// `vision-ready-input`.
    pub input: Ready,
    /// `vision-ready-output`.
    pub output: Ready,
    /// The response area.
    pub response: VisionResponse,
}

impl Areas {
    /// As initialization leaves them (IX.4, blocks 984-986).
    pub const INITIALIZED: Self = Self {
        input: Ready::Ready,
        output: Ready::NotReady,
        response: VisionResponse {
            echo: 0,
            status: VisionStatus::Idle,
            y: 0,
            z: 0,
            angle: 0,
            recognised: None,
        },
    };

    /// The bytes.
    ///
    /// # Errors
    /// [`RangeError`] if two bytes cannot hold a value.
    pub fn encode(&self) -> Result<[u8; AREAS], RangeError> {
        let response = &self.response;
        let mut fields = Packer::<AREAS>::default();
        fields.word(self.input as u16);
        fields.word(self.output as u16);
        fields.word(u16::try_from(AREA).unwrap_or_default());
        fields.word(command_number(response.echo));
        fields.word(u16::from(response.status.code()));
        fields.integer("y", response.y)?;
        fields.integer("z", response.z)?;
        fields.integer("angle", response.angle)?;
        fields.word(response.recognised.unwrap_or_default());
        Ok(fields.finish())
    }

    /// Read the bytes. Whether the values can be is for E-move to judge.
    ///
    /// # Errors
    /// [`VisionError`] for the first thing that cannot be read.
    pub fn decode(bytes: &[u8]) -> Result<Self, VisionError> {
        if bytes.len() != AREAS {
            return Err(VisionError::Length { what: "a response", expected: AREAS, found: bytes.len() });
        }
        let mut fields = Unpacker::new(bytes);
        let mut ready = |field| fields.word(field).map(|word| Ready::from_word(field, word));
        let (input, output) = (ready("vision-ready-input")??, ready("vision-ready-output")??);
        let count = fields.word("response-byte-count")?;
        if usize::from(count) != AREA {
            return Err(VisionError::ByteCount {
                field: "response-byte-count",
                expected: AREA,
                found: count,
            });
        }
        let (echo, status) = (fields.word("request-#-echo")?.into(), fields.word("status")?);
        let response = VisionResponse {
            echo,
            status: u8::try_from(status)
                .ok()
                .and_then(VisionStatus::from_code)
                .ok_or(FieldError::Code { field: "status", found: status })?,
            y: fields.integer("y")?,
            z: fields.integer("z")?,
            angle: fields.integer("angle")?,
            recognised: Some(fields.word("recognised")?).filter(|id| *id != 0),
        };
        Ok(Self { input, output, response })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn areas() -> Areas {
        let response = VisionResponse {
            echo: 4,
            status: VisionStatus::Done,
            y: 150,
            z: -75,
            angle: 3438,
            recognised: Some(17),
        };
        Areas { input: Ready::Ready, output: Ready::NotReady, response }
    }

    #[test]
    fn every_field_stands_at_its_byte() {
        let bytes = areas().encode().unwrap();
        assert_eq!(bytes, *b"\x02\x00\x01\x00\x0C\x00\x04\x00\x02\x00\x96\x00\xB5\xFF\x6E\x0D\x11\x00");
        assert_eq!(Areas::decode(&bytes), Ok(areas()));
        let initialized = Areas::INITIALIZED.encode().unwrap();
        assert_eq!(&initialized[..8], b"\x02\x00\x01\x00\x0C\x00\x00\x00");
    }

    #[test]
    fn what_is_no_response_says_why() {
        let said = |at: usize, byte: u8| {
            let mut bytes = areas().encode().unwrap();
            bytes[at] = byte;
            Areas::decode(&bytes).unwrap_err().to_string()
        };
        assert_eq!(said(0, 3), "1 (not ready) or 2 (ready) was expected for vision-ready-input, found 3");
        assert_eq!(said(2, 0), "1 (not ready) or 2 (ready) was expected for vision-ready-output, found 0");
        assert_eq!(said(4, 14), "response-byte-count 12 was expected, found 14");
        assert_eq!(said(8, 99), "99 is no code of status");
        let short = Areas::decode(&[2; 14]).unwrap_err().to_string();
        assert_eq!(short, "a response of 18 bytes was expected, found 14");
    }

    #[test]
    fn values_that_two_bytes_cannot_hold_are_refused() {
        let response = VisionResponse { y: 40_000, ..areas().response };
        let refused = Areas { response, ..areas() }.encode().unwrap_err();
        assert_eq!(refused.to_string(), "an integer of two bytes was expected for y, found 40000");
    }

    proptest! {
        #[test]
        fn no_bytes_panic_and_what_is_read_is_what_was_written(
            bytes in prop::collection::vec(any::<u8>(), 0..30),
            likely in any::<[u8; 12]>(),
        ) {
            let near = [b"\x02\x00\x01\x00\x0C\x00", &likely[..2], &[likely[2] % 6, 0], &likely[4..]].concat();
            for bytes in [bytes, near] {
                if let Ok(areas) = Areas::decode(&bytes) {
                    prop_assert_eq!(&areas.encode().unwrap()[..], &bytes[..]);
                }
            }
        }
    }
}
