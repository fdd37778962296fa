//! What the camera of the simulated cell sees, byte by byte: an extension for a vision system that has no camera of its own. A real
//! one does not read it. All numbers are those of the cell to the last bit, so that the answer is the same wherever it is worked out.
//!
//! ```text
//!   at  bytes
//!    0    2    request-# for which the picture was taken
//!    2    2    parts of which something is seen, 0 to 38; the nearest to the optical axis if there are more
//!    4    8    seed of the run, unsigned
//!   12    8    fingerprint of camera and parts in the cell description of the run
//!   20  107    each part: the face that looks at the camera, in camera axes (X along the optical axis, Y the tool's Y), inches, f64
//!
//!    0   24      its middle: X, Y, Z
//!   24   32      its first edge: direction X, Y, Z and length
//!   56   32      its second edge, likewise
//!   88    8      share of the light that it throws back
//!   96   11      what of it is seen: 9 points along the first edge by 9 along the second, the middles of equal fields, bit n % 8 of
//!                byte n / 8 for the nth, those along the second edge first
//! ```

use super::VisionError;
use crate::{
    fields::{FieldError, Unpacker},
    mailbox::{HEAD as MAILBOX_HEAD, VISION_PICTURE},
};

/// Bytes in front of the parts.
pub const HEAD: usize = 20;
/// Bytes of a part.
pub const PART: usize = 107;
/// Parts that the mailbox holds.
pub const MAX_PARTS: usize = (VISION_PICTURE.size - MAILBOX_HEAD - HEAD) / PART;
/// Points of a face.
const POINTS: u32 = 81;

/// A picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picture {
    /// Number of the request for which it was taken.
    pub number: u16,
    /// Seed of the run.
    pub seed: u64,
    /// Fingerprint of what the answer depends on in the cell description.
    pub cell: u64,
    /// Parts of which something is seen.
    pub parts: Vec<Part>,
}

/// A part in a picture: its face that looks at the camera, in camera axes, in.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Part {
    /// Middle of the face.
    pub centre: [f64; 3],
    /// Directions and lengths of its edges.
    pub edges: [([f64; 3], f64); 2],
    /// Share of the light that it throws back.
    pub reflectance: f64,
    /// Which points are seen: bit n for the nth.
    pub seen: u128,
}

impl Picture {
    /// Leave out the parts farthest from the optical axis, if there are more than the mailbox holds; how many.
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

    /// The bytes; not more parts than [`MAX_PARTS`] ([`Picture::crop`]).
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        let parts = &self.parts[..self.parts.len().min(MAX_PARTS)];
        let mut bytes = Vec::with_capacity(HEAD + PART * parts.len());
        bytes.extend(self.number.to_le_bytes());
        bytes.extend(u16::try_from(parts.len()).unwrap_or_default().to_le_bytes());
        bytes.extend(self.seed.to_le_bytes());
        bytes.extend(self.cell.to_le_bytes());
        for part in parts {
            let edges = part.edges.iter().flat_map(|(direction, length)| direction.iter().chain([length]));
            let numbers = part.centre.iter().chain(edges).chain([&part.reflectance]);
            bytes.extend(numbers.flat_map(|number| number.to_le_bytes()));
            bytes.extend(&part.seen.to_le_bytes()[..PART - 96]);
        }
        bytes
    }

    /// Read the bytes.
    ///
    /// # Errors
    /// [`VisionError`] for the first thing that cannot be.
    pub fn decode(bytes: &[u8]) -> Result<Self, VisionError> {
        let mut fields = Unpacker::new(bytes);
        let (number, count) = (fields.word("request-#")?, fields.word("parts")?);
        let expected = HEAD + PART * usize::from(count);
        let (seed, cell) = (long(&mut fields, "seed")?, long(&mut fields, "fingerprint")?);
        if bytes.len() != expected || usize::from(count) > MAX_PARTS {
            return Err(VisionError::Length { what: "a picture", expected, found: bytes.len() });
        }
        let parts = (1..=usize::from(count)).map(|part| read_part(&mut fields, part));
        Ok(Self { number, seed, cell, parts: parts.collect::<Result<_, _>>()? })
    }
}

fn long(fields: &mut Unpacker<'_>, field: &'static str) -> Result<u64, FieldError> {
    let bytes = fields.raw(field, 8)?;
    bytes.try_into().map(u64::from_le_bytes).map_err(|_| FieldError::End { field })
}

fn read_part(fields: &mut Unpacker<'_>, part: usize) -> Result<Part, VisionError> {
    let mut number = |field| {
        let found = f64::from_bits(long(fields, field)?);
        if found.is_finite() { Ok(found) } else { Err(VisionError::Number { field, part, found }) }
    };
    let mut three = |field| Ok::<_, VisionError>([number(field)?, number(field)?, number(field)?]);
    let centre = three("the middle")?;
    let first = three("the first edge")?;
    let length = number("the first edge")?;
    let mut three = |field| Ok::<_, VisionError>([number(field)?, number(field)?, number(field)?]);
    let second = three("the second edge")?;
    let edges = [(first, length), (second, number("the second edge")?)];
    let reflectance = number("the light")?;
    let mut seen = [0; 16];
    let raster = fields.raw("the points", PART - 96)?;
    seen[..raster.len()].copy_from_slice(raster);
    let seen = u128::from_le_bytes(seen);
    if seen >> POINTS != 0 {
        let found = u16::from(raster.last().copied().unwrap_or_default());
        return Err(FieldError::Code { field: "the points", found }.into());
    }
    Ok(Part { centre, edges, reflectance, seen })
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
    fn every_field_stands_at_its_byte() {
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
    fn a_crowd_is_cropped_to_what_the_mailbox_holds() {
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
    fn what_is_no_picture_says_why() {
        let said = |change: fn(&mut Vec<u8>)| {
            let mut bytes = picture(2).encode();
            change(&mut bytes);
            Picture::decode(&bytes).unwrap_err().to_string()
        };
        assert_eq!(said(|bytes| bytes.truncate(200)), "a picture of 234 bytes was expected, found 200");
        assert_eq!(said(|bytes| bytes.truncate(10)), "the data end before seed does");
        assert_eq!(said(|bytes| bytes[3] = 9), "a picture of 246762 bytes was expected, found 234");
        let endless = said(|bytes| bytes[28..36].copy_from_slice(&f64::INFINITY.to_le_bytes()));
        assert_eq!(endless, "a finite number was expected for the middle of part 1, found inf");
        assert_eq!(said(|bytes| bytes[233] = 3), "3 is no code of the points");
    }

    proptest! {
        #[test]
        fn no_bytes_panic_and_what_is_read_is_what_was_written(
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
