//! The request to vision, byte by byte (IX.4, V.2.1, VII.7.6). CHOSEN, Figure IX.3 is lost.
//!
//! ```text
//!   at  bytes  variable             holds
//!    0    2    request-byte-count   bytes of the request area behind it, 12
//!    2    2    request-#            another one than the last is a new request; 1 to 65535, then 1 again
//!    4    2    picture              1 fast flood: approximate centroid; 2 precise: centroid, angle, recognition
//!    6    2    object-id            of VISION-PARA: what is to be recognised
//!    8    2    grip-#               1 across the widest dimension, 2 across the shortest
//!   10    2    range                expected, from the image plane to the object, mm
//!   12    2    variation            parameters to be used: 0 first, another one for each picture that is taken again
//! ```

use rcs_core::interface::device::{Picture, VisionRequest};

use super::VisionError;
use crate::fields::{FieldError, Packer, Unpacker, command_number};

/// Bytes of the data of a request mailbox.
pub const REQUEST: usize = 14;
/// `request-byte-count`.
const AREA: usize = REQUEST - 2;

/// The bytes of a request. Its number is that of the mailbox ([`command_number`]).
#[must_use]
pub fn encode(request: &VisionRequest) -> [u8; REQUEST] {
    let mut fields = Packer::<REQUEST>::default();
    fields.word(u16::try_from(AREA).unwrap_or_default());
    fields.word(command_number(request.number));
    fields.word(u16::from(request.picture.code()));
    fields.word(request.object_id);
    fields.saturated(request.grip.into());
    fields.word(request.range_mm);
    fields.word(request.variation.into());
    fields.finish()
}

/// Read the bytes of a request.
///
/// # Errors
/// [`VisionError`] for the first thing that cannot be.
pub fn decode(bytes: &[u8]) -> Result<VisionRequest, VisionError> {
    if bytes.len() != REQUEST {
        return Err(VisionError::Length { what: "a request", expected: REQUEST, found: bytes.len() });
    }
    let mut fields = Unpacker::new(bytes);
    let count = fields.word("request-byte-count")?;
    if usize::from(count) != AREA {
        return Err(VisionError::ByteCount { field: "request-byte-count", expected: AREA, found: count });
    }
    let (number, picture) = (fields.word("request-#")?, fields.word("picture")?);
    let (object_id, grip) = (fields.word("object-id")?, fields.integer("grip-#")?);
    let (range_mm, variation) = (fields.word("range")?, fields.word("variation")?);
    let picture = u8::try_from(picture).ok().and_then(Picture::from_code);
    let picture = picture.filter(|picture| *picture != Picture::None);
    let code = |field, found| VisionError::Field(FieldError::Code { field, found });
    Ok(VisionRequest {
        number: number.into(),
        picture: picture.ok_or_else(|| code("picture", u16::from_le_bytes([bytes[4], bytes[5]])))?,
        object_id,
        grip: i16::try_from(grip).unwrap_or_default(),
        range_mm,
        variation: u8::try_from(variation).map_err(|_| code("variation", variation))?,
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn request() -> VisionRequest {
        VisionRequest {
            number: 4,
            picture: Picture::Precise,
            object_id: 17,
            grip: -2,
            range_mm: 605,
            variation: 1,
        }
    }

    #[test]
    fn every_field_stands_at_its_byte() {
        let bytes = encode(&request());
        assert_eq!(bytes, *b"\x0C\x00\x04\x00\x02\x00\x11\x00\xFE\xFF\x5D\x02\x01\x00");
        assert_eq!(decode(&bytes), Ok(request()));
        let wrapped = VisionRequest { number: 65_539, ..request() };
        assert_eq!(decode(&encode(&wrapped)), Ok(request()), "numbers of the mailbox have two bytes");
    }

    #[test]
    fn what_is_no_request_says_why() {
        let said = |at: usize, byte: u8| {
            let mut bytes = encode(&request());
            bytes[at] = byte;
            decode(&bytes).unwrap_err().to_string()
        };
        assert_eq!(said(0, 11), "request-byte-count 12 was expected, found 11");
        assert_eq!(said(4, 0), "0 is no code of picture");
        assert_eq!(said(4, 7), "7 is no code of picture");
        assert_eq!(said(13, 1), "257 is no code of variation");
        assert_eq!(decode(&[0; 13]).unwrap_err().to_string(), "a request of 14 bytes was expected, found 13");
    }

    proptest! {
        #[test]
        fn no_bytes_panic_and_what_is_read_is_what_was_written(
            bytes in prop::collection::vec(any::<u8>(), 0..30)
        ) {
            if let Ok(request) = decode(&bytes) {
                prop_assert_eq!(&encode(&request)[..], &bytes[..]);
            }
        }
    }
}
