//! The request to vision (IX.4, V.2.1, VII.7.6). CHOSEN, Figure IX.3 is lost.

use interfaces::device::{Picture, VisionRequest};

use super::{VisionError, areas::ByteCount};
use crate::{
    fields::FieldError,
    layout::{Coded, I16, Number, U16},
};

crate::layout! {
    /// The request to vision.
    RequestLayout: VisionRequest = "a request";
    "request-byte-count"  ()           ByteCount,  "12";
    "request-#"           (number)     Number,
        "a different number is a new request; 1 to 65535, then 1 again";
    "picture"             (picture)    Coded<2>,
        "1 fast flood: approximate centroid; 2 precise: centroid, angle, recognition";
    "object-id"           (object_id)  U16,        "the object to recognise (VII.7.6)";
    "grip-#"              (grip)       I16,
        "signed; 1 across the widest dimension, 2 across the shortest";
    "range"               (range_mm)   U16,        "expected, mm";
    "variation"           (variation)  U16,
        "of the system's parameters: 0 first, another value for each repeated picture";
}

/// The number is reduced to the range of the mailbox, 1 to 65535.
#[must_use]
pub fn encode(request: &VisionRequest) -> [u8; RequestLayout::BYTES] {
    RequestLayout::encode(request)
}

pub fn decode(bytes: &[u8]) -> Result<VisionRequest, VisionError> {
    let request = RequestLayout::decode(bytes)?;
    if request.picture == Picture::None {
        return Err(VisionError::Field(FieldError::Code { field: "picture", found: 0 }));
    }
    Ok(request)
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
    fn every_field_is_at_its_byte() {
        let bytes = encode(&request());
        assert_eq!(bytes, *b"\x0C\x00\x04\x00\x02\x00\x11\x00\xFE\xFF\x5D\x02\x01\x00");
        assert_eq!(decode(&bytes), Ok(request()));
        let wrapped = VisionRequest { number: 65_539, ..request() };
        assert_eq!(decode(&encode(&wrapped)), Ok(request()), "numbers of the mailbox have two bytes");
    }

    #[test]
    fn invalid_requests_are_refused_with_the_reason() {
        let said = |at: usize, byte: u8| {
            let mut bytes = encode(&request());
            bytes[at] = byte;
            decode(&bytes).unwrap_err().to_string()
        };
        assert_eq!(said(0, 11), "12 was expected for request-byte-count, found 11");
        assert_eq!(said(4, 0), "0 is not a code of picture");
        assert_eq!(said(4, 7), "7 is not a code of picture");
        assert_eq!(said(13, 1), "257 is not a code of variation");
        assert_eq!(decode(&[0; 13]).unwrap_err().to_string(), "a request of 14 bytes was expected, found 13");
    }

    proptest! {
        #[test]
        fn arbitrary_bytes_do_not_panic_and_written_ones_round_trip(
            bytes in prop::collection::vec(any::<u8>(), 0..30)
        ) {
            if let Ok(request) = decode(&bytes) {
                prop_assert_eq!(&encode(&request)[..], &bytes[..]);
            }
        }
    }
}
