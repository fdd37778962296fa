//! The picture of the simulated camera, for a vision system without a camera: an extension. Numbers equal those of the
//! cell exactly, so that every process computes the same answer.

use super::VisionError;
use crate::{
    fields::FieldError,
    layout::{At, Codec, U16, U64, Width, sized},
    mailbox::{HEAD as MAILBOX_HEAD, VISION_PICTURE},
};

crate::layout! {
    /// The head before the parts.
    HeadLayout: Head = "the head of a picture";
    "request-#"    (number)  U16,  "request for which the picture was taken";
    "parts"        (parts)   U16,
        "number of visible parts, 0 to 38; if there are more, those nearest to the optical axis";
    "seed"         (seed)    U64,  "seed of the run";
    "fingerprint"  (cell)    U64,  "of camera and parts in the cell description of the run";
}

crate::layout! {
    /// A part.
    PartLayout: Part = "a part";
    "middle"       (centre)       Vector,  "of the face that looks at the camera: X, Y, Z";
    "edge 1"       (edges[0].0)   Vector,  "direction of its first edge: X, Y, Z";
    "length 1"     (edges[0].1)   Number,  "of that edge";
    "edge 2"       (edges[1].0)   Vector,  "direction of its second edge";
    "length 2"     (edges[1].1)   Number,  "of that edge";
    "reflectance"  (reflectance)  Number,  "share of the light that it reflects";
    "points"       (seen)         Points,
        "which of 9 by 9 points of it, the middles of equal fields, are seen: bit n % 8 of byte n / 8 for the nth, \
         those along the second edge first";
}

pub const HEAD: usize = HeadLayout::BYTES; // bytes before the parts
pub const PART: usize = PartLayout::BYTES;
pub const MAX_PARTS: usize = (VISION_PICTURE.size - MAILBOX_HEAD - HEAD) / PART;
const POINTS: u32 = 81;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Head {
    number: u16,
    parts: u16,
    seed: u64,
    cell: u64,
}

#[derive(Clone, Copy, Debug)]
struct Number; // finite, 64 bits

#[derive(Clone, Copy, Debug)]
struct Vector; // finite, 64 bits each

#[derive(Clone, Copy, Debug)]
struct Points; // a bit for each point of a face

impl Width for Number {
    const BYTES: usize = 8;
}

impl Width for Vector {
    const BYTES: usize = 3 * Number::BYTES;
}

impl Width for Points {
    const BYTES: usize = POINTS.div_ceil(u8::BITS) as usize;
}

impl Codec<'_, f64> for Number {
    fn put(value: &f64, to: &mut [u8]) {
        U64::put(value, to);
    }

    fn take(at: At, from: &[u8]) -> Result<f64, FieldError> {
        let found: f64 = U64::take(at, from)?;
        if found.is_finite() { Ok(found) } else { Err(FieldError::Infinite { field: at.field }) }
    }
}

impl Codec<'_, [f64; 3]> for Vector {
    fn put(value: &[f64; 3], to: &mut [u8]) {
        for (number, to) in value.iter().zip(to.chunks_mut(Number::BYTES)) {
            Number::put(number, to);
        }
    }

    fn take(at: At, from: &[u8]) -> Result<[f64; 3], FieldError> {
        let mut read = [0.0; 3];
        for (number, from) in read.iter_mut().zip(from.chunks(Number::BYTES)) {
            *number = Number::take(at, from)?;
        }
        Ok(read)
    }
}

impl Codec<'_, u128> for Points {
    fn put(value: &u128, to: &mut [u8]) {
        to.copy_from_slice(&value.to_le_bytes()[..Self::BYTES]);
    }

    fn take(at: At, from: &[u8]) -> Result<u128, FieldError> {
        let mut bytes = [0; 16];
        bytes[..Self::BYTES].copy_from_slice(from);
        let seen = u128::from_le_bytes(bytes);
        if seen >> POINTS == 0 {
            return Ok(seen);
        }
        Err(FieldError::Code { field: at.field, found: u16::from(bytes[Self::BYTES - 1]) })
    }
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    pub number: u16, // of the request
    pub seed: u64,
    pub cell: u64, // fingerprint of the entries of the cell description on which the answer depends
    pub parts: Vec<Part>,
}

/// The face towards the camera, in camera axes, in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Part {
    pub centre: [f64; 3],
    pub edges: [([f64; 3], f64); 2], // directions and lengths
    pub reflectance: f64,            // share of the light
    pub seen: u128,                  // bit n: the nth point is visible
}

impl Picture {
    /// Leaves out the parts farthest from the optical axis if they do not fit. Returns their number.
    pub fn crop(&mut self) -> usize {
        let Some(excess) = self.parts.len().checked_sub(MAX_PARTS).filter(|excess| *excess > 0) else {
            return 0;
        };
        let away = |part: &Part| part.centre[1].hypot(part.centre[2]);
        let mut distances: Vec<f64> = self.parts.iter().map(away).collect();
        distances.sort_by(f64::total_cmp);
        let farthest = distances[MAX_PARTS - 1];
        self.parts.retain(|part| away(part) <= farthest);
        self.parts.truncate(MAX_PARTS);
        excess
    }

    /// Encodes at most [`MAX_PARTS`] parts: call [`Picture::crop`] first.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        let parts = &self.parts[..self.parts.len().min(MAX_PARTS)];
        let count = u16::try_from(parts.len()).unwrap_or_default();
        let head = Head { number: self.number, parts: count, seed: self.seed, cell: self.cell };
        let mut bytes = Vec::with_capacity(HEAD + PART * parts.len());
        bytes.extend(HeadLayout::encode(&head));
        bytes.extend(parts.iter().flat_map(PartLayout::encode));
        bytes
    }

    pub fn decode(bytes: &[u8]) -> Result<Self, VisionError> {
        let (head, rest) = bytes.split_at(bytes.len().min(HEAD));
        let Head { number, parts, seed, cell } = HeadLayout::decode(head)?;
        let count = usize::from(parts);
        sized("a picture", HEAD + PART * count.min(MAX_PARTS), bytes)?;
        if count > MAX_PARTS {
            return Err(VisionError::Parts { most: MAX_PARTS, found: count });
        }
        let part = |(at, bytes): (usize, &[u8])| {
            PartLayout::decode(bytes).map_err(|source| VisionError::Part { part: at + 1, source })
        };
        let parts = rest.chunks(PART).enumerate().map(part);
        Ok(Self { number, seed, cell, parts: parts.collect::<Result<_, _>>()? })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn part(y: f64) -> Part {
        Part {
            centre: [23.8, y, -0.5],
            edges: [([0.0, 1.0, 0.0], 0.625), ([0.0, 0.0, 1.0], 4.0)],
            reflectance: 0.5,
            seen: (1 << POINTS) - 1,
        }
    }

    fn picture(parts: usize) -> Picture {
        let parts = (0..parts).map(|number| part(number as f64)).collect();
        Picture { number: 4, seed: 1, cell: 0x0102_0304_0506_0708, parts }
    }

    #[test]
    fn every_field_is_at_its_byte() {
        let bytes = picture(1).encode();
        assert_eq!(bytes.len(), HEAD + PART);
        assert_eq!(bytes[..HEAD], *b"\x04\x00\x01\x00\x01\0\0\0\0\0\0\0\x08\x07\x06\x05\x04\x03\x02\x01");
        assert_eq!(bytes[20..28], 23.8_f64.to_le_bytes());
        assert_eq!(bytes[68..76], 0.625_f64.to_le_bytes());
        assert_eq!(bytes[100..108], 4.0_f64.to_le_bytes());
        assert_eq!(bytes[108..116], 0.5_f64.to_le_bytes());
        assert_eq!(bytes[116..], *b"\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF\x01");
        assert_eq!(Picture::decode(&bytes), Ok(picture(1)));
    }

    #[test]
    fn picture_is_cropped_to_the_size_of_the_mailbox() {
        let mut crowd = picture(MAX_PARTS + 3);
        crowd.parts.reverse();
        assert_eq!(crowd.crop(), 3);
        assert_eq!((crowd.parts.len(), crowd.crop()), (MAX_PARTS, 0));
        assert_eq!(crowd.parts[0], part((MAX_PARTS - 1) as f64), "in their order");
        let bytes = crowd.encode();
        assert!(bytes.len() <= VISION_PICTURE.size - MAILBOX_HEAD);
        assert_eq!(Picture::decode(&bytes), Ok(crowd));
    }

    #[test]
    fn invalid_pictures_are_refused_with_the_reason() {
        let said = |change: fn(&mut Vec<u8>)| {
            let mut bytes = picture(2).encode();
            change(&mut bytes);
            Picture::decode(&bytes).unwrap_err().to_string()
        };
        assert_eq!(said(|bytes| bytes.truncate(200)), "a picture of 234 bytes was expected, found 200");
        assert_eq!(
            said(|bytes| bytes.truncate(10)),
            "the head of a picture of 20 bytes was expected, found 10"
        );
        assert_eq!(said(|bytes| bytes[3] = 9), "a picture of 4086 bytes was expected, found 234");
        let many = said(|bytes| {
            bytes[2..4].copy_from_slice(&[39, 0]);
            bytes.resize(HEAD + PART * MAX_PARTS, 0);
        });
        assert_eq!(many, "at most 38 parts were expected in a picture, found 39");
        let endless = said(|bytes| bytes[28..36].copy_from_slice(&f64::INFINITY.to_le_bytes()));
        assert_eq!(endless, "part 1: a finite number was expected for middle");
        assert_eq!(said(|bytes| bytes[233] = 3), "part 2: 3 is not a code of points");
    }

    proptest! {
        #[test]
        fn arbitrary_bytes_do_not_panic_and_written_ones_round_trip(
            bytes in prop::collection::vec(any::<u8>(), 0..300),
            count in 0_u16..3,
        ) {
            let mut near = bytes.clone();
            near.resize(HEAD + PART * usize::from(count), 0);
            near[2..4].copy_from_slice(&count.to_le_bytes());
            for bytes in [bytes, near] {
                if let Ok(picture) = Picture::decode(&bytes) {
                    prop_assert_eq!(picture.encode(), bytes);
                }
            }
        }
    }
}
