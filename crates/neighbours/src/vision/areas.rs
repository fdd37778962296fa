//! The areas that vision writes (IX.4): ready words and response. CHOSEN: Figure IX.3 is lost.

use interfaces::device::{VisionResponse, VisionStatus};

use super::VisionError;
use crate::{
    fields::{FieldError, RangeError},
    layout::{At, Codec, Coded, Given, I16, Number, U16, Width},
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Ready {
    NotReady = 1, // must not be used (CHOSEN: no number in the manual)
    Ready = 2,    // may be read or written (IX.4)
}

#[derive(Clone, Copy, Debug)]
struct ReadyWord;

impl Width for ReadyWord {
    const BYTES: usize = 2;
}

impl Codec<'_, Ready> for ReadyWord {
    fn put(value: &Ready, to: &mut [u8]) {
        U16::put(&(*value as u16), to);
    }

    fn take(at: At, from: &[u8]) -> Result<Ready, FieldError> {
        let found: u16 = U16::take(at, from)?;
        let expected = "1 (not ready) or 2 (ready)";
        let known = [Ready::NotReady, Ready::Ready].into_iter().find(|&ready| ready as u16 == found);
        known.ok_or(FieldError::Expected { field: at.field, expected, found })
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct ByteCount; // always 12, the number of bytes after it

impl Width for ByteCount {
    const BYTES: usize = 2;
}

impl Codec<'_, ()> for ByteCount {
    fn put((): &(), to: &mut [u8]) {
        U16::put(&12_u16, to);
    }

    fn take(at: At, from: &[u8]) -> Result<(), FieldError> {
        match U16::take(at, from)? {
            12_u16 => Ok(()),
            found => Err(FieldError::Expected { field: at.field, expected: "12", found }),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Areas {
    pub input: Ready,  // `vision-ready-input`
    pub output: Ready, // `vision-ready-output`
    pub response: VisionResponse,
}

impl Default for Areas {
    fn default() -> Self {
        Self::INITIALIZED
    }
}

crate::layout! {
    /// What vision writes.
    AreasLayout: Areas = "a response";
    "vision-ready-input"   (input)   ReadyWord,  "2: the response may be read";
    "vision-ready-output"  (output)  ReadyWord,  "2: a request may be written";
    "response-byte-count"  ()        ByteCount,  "12";
    "request-#-echo"  (response.echo)    Number,     "the request that is answered; 0 for none";
    "status"          (response.status)  Coded<2>,
        "0 none; 1 busy; 2 done; 3 nothing seen; 4 not recognised";
    "y"               (response.y)       I16,
        "centroid from the optical axis along the tool's Y, 0.01 in, signed";
    "z"               (response.z)       I16,
        "the same along Z = X x Y, where X is the optical axis away from the camera";
    "angle"           (response.angle)   I16,
        "right-hand roll about X that brings Y onto the dimension to grip across, 0.01 degree, -9000 to 9000";
    "recognised"      (response.recognised)  Given<U16>,
        "object-id of what was recognised, 0 for none; after a precise picture it must be the one asked for";
}

impl Areas {
    /// The areas after initialization (IX.4, blocks 984-986).
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

    /// Fails if two bytes cannot hold a value.
    pub fn encode(&self) -> Result<[u8; AreasLayout::BYTES], RangeError> {
        AreasLayout::check(self).map(|()| AreasLayout::encode(self))
    }

    /// The error names the first unreadable field. E-move checks the values.
    pub fn decode(bytes: &[u8]) -> Result<Self, VisionError> {
        Ok(AreasLayout::decode(bytes)?)
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
    fn every_field_is_at_its_byte() {
        let bytes = areas().encode().unwrap();
        assert_eq!(bytes, *b"\x02\x00\x01\x00\x0C\x00\x04\x00\x02\x00\x96\x00\xB5\xFF\x6E\x0D\x11\x00");
        assert_eq!(Areas::decode(&bytes), Ok(areas()));
        let initialized = Areas::INITIALIZED.encode().unwrap();
        assert_eq!(&initialized[..8], b"\x02\x00\x01\x00\x0C\x00\x00\x00");
    }

    #[test]
    fn invalid_responses_are_refused_with_the_reason() {
        let said = |at: usize, byte: u8| {
            let mut bytes = areas().encode().unwrap();
            bytes[at] = byte;
            Areas::decode(&bytes).unwrap_err().to_string()
        };
        assert_eq!(said(0, 3), "1 (not ready) or 2 (ready) was expected for vision-ready-input, found 3");
        assert_eq!(said(2, 0), "1 (not ready) or 2 (ready) was expected for vision-ready-output, found 0");
        assert_eq!(said(4, 14), "12 was expected for response-byte-count, found 14");
        assert_eq!(said(8, 99), "99 is not a code of status");
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
        fn arbitrary_bytes_do_not_panic_and_written_ones_round_trip(
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
