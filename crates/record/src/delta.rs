//! Images of one tick as their difference from the previous tick, field by field.
//!
//! In a quiet tick a few of some hundreds of fields change, most by a little. A delta lists the changed fields and the
//! difference of each, as varints with the sign in the lowest bit:
//!
//! ```text
//! count of changed fields | fields to skip before each | the differences in sequence
//! ```
//!
//! The skips are stored together because they hardly differ, and compress well. Names and frames on the line are bytes,
//! whose difference is a list of runs. A full image is a delta from zeros.

use rcs_core::{plain::StructSchema, reflect};

use crate::{
    layout::{self, Piece},
    proto::wire::{put_varint, take_varint, unzigzag, zigzag},
};

const GAP: usize = 4; // equal bytes that end a run: a shorter gap costs more as a new run than as bytes

#[derive(Clone, Debug)]
pub struct Codec {
    pieces: Vec<Piece>,
    size: usize,
}

impl Codec {
    #[must_use]
    pub fn new(record: &'static StructSchema) -> Self {
        Self { pieces: layout::pieces(record), size: record.size() }
    }

    #[must_use]
    pub const fn size(&self) -> usize {
        self.size
    }

    pub fn encode(&self, from: &[u8], to: &[u8], out: &mut Vec<u8>) {
        let (mut count, mut skipped) = (0, 0);
        let (mut skips, mut values) = (Vec::new(), Vec::new());
        for piece in &self.pieces {
            let (was, is) = (piece.bytes(from), piece.bytes(to));
            if was == is {
                skipped += 1;
                continue;
            }
            put_varint(skipped, &mut skips);
            (count, skipped) = (count + 1, 0);
            piece.encode(was, is, &mut values);
        }
        put_varint(count, out);
        out.extend_from_slice(&skips);
        out.extend_from_slice(&values);
    }

    /// Apply `delta` to `image`. Returns false if the delta does not fit; the image is then invalid.
    #[must_use]
    pub fn apply(&self, delta: &[u8], image: &mut [u8]) -> bool {
        self.try_apply(delta, image).is_some()
    }

    fn try_apply(&self, mut delta: &[u8], image: &mut [u8]) -> Option<()> {
        let count = usize::try_from(take_varint(&mut delta)?).ok()?;
        if count > self.pieces.len() {
            return None;
        }
        let mut values = delta;
        for _ in 0..count {
            take_varint(&mut values)?;
        }
        let mut pieces = self.pieces.iter();
        for _ in 0..count {
            let piece = pieces.nth(usize::try_from(take_varint(&mut delta)?).ok()?)?;
            let field = image.get_mut(piece.offset..piece.offset + piece.size)?;
            piece.apply(&mut values, field)?;
        }
        values.is_empty().then_some(())
    }
}

impl Piece {
    fn bytes<'a>(&self, image: &'a [u8]) -> &'a [u8] {
        image.get(self.offset..self.offset + self.size).unwrap_or_default()
    }

    fn encode(&self, was: &[u8], is: &[u8], out: &mut Vec<u8>) {
        if self.number {
            let unused = 64 - 8 * self.size.clamp(1, 8);
            let difference = reflect::unsigned(is).wrapping_sub(reflect::unsigned(was));
            put_varint(zigzag((difference << unused).cast_signed() >> unused), out);
        } else {
            let mut runs = Vec::new();
            encode_runs(was, is, &mut runs);
            put_varint(runs.len() as u64, out);
            out.extend_from_slice(&runs);
        }
    }

    fn apply(&self, values: &mut &[u8], field: &mut [u8]) -> Option<()> {
        let value = take_varint(values)?;
        if self.number {
            add(field, unzigzag(value).cast_unsigned());
            return Some(());
        }
        let (runs, rest) = values.split_at_checked(usize::try_from(value).ok()?)?;
        *values = rest;
        apply_runs(runs, field)
    }
}

/// Add to a number of at most eight bytes, with wrap-around.
fn add(field: &mut [u8], difference: u64) {
    let [a, b, c, d, ..] = difference.to_le_bytes();
    if let Ok(field) = <&mut [u8; 4]>::try_from(&mut *field) {
        *field = u32::from_le_bytes(*field).wrapping_add(u32::from_le_bytes([a, b, c, d])).to_le_bytes();
    } else if let Ok(field) = <&mut [u8; 8]>::try_from(&mut *field) {
        *field = u64::from_le_bytes(*field).wrapping_add(difference).to_le_bytes();
    } else {
        let sum = reflect::unsigned(field).wrapping_add(difference);
        field.iter_mut().zip(sum.to_le_bytes()).for_each(|(slot, byte)| *slot = byte);
    }
}

/// A list of runs, each *bytes to skip*, *bytes that follow* (both as varints) and those bytes.
fn encode_runs(from: &[u8], to: &[u8], out: &mut Vec<u8>) {
    let differs = |at: usize| from.get(at) != to.get(at);
    let (mut written, mut at) = (0, 0);
    while at < to.len() {
        if !differs(at) {
            at += 1;
            continue;
        }
        let (start, mut end, mut equal) = (at, at + 1, 0);
        at += 1;
        while at < to.len() && equal < GAP {
            if differs(at) {
                (end, equal) = (at + 1, 0);
            } else {
                equal += 1;
            }
            at += 1;
        }
        let run = to.get(start..end).unwrap_or_default();
        put_varint((start - written) as u64, out);
        put_varint(run.len() as u64, out);
        out.extend_from_slice(run);
        written = end;
    }
}

fn apply_runs(mut runs: &[u8], field: &mut [u8]) -> Option<()> {
    let mut at = 0_usize;
    while !runs.is_empty() {
        let skip = usize::try_from(take_varint(&mut runs)?).ok()?;
        let length = usize::try_from(take_varint(&mut runs)?).ok()?;
        let start = at.checked_add(skip)?;
        at = start.checked_add(length)?;
        let (bytes, rest) = runs.split_at_checked(length)?;
        field.get_mut(start..at)?.copy_from_slice(bytes);
        runs = rest;
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{CommonMemory, ExternalInputs};
    use levels::ladder::LadderState;
    use proptest::prelude::*;
    use rcs_core::{Plain, plain::Writer};

    fn image<T: Plain>(record: &T) -> Vec<u8> {
        let mut bytes = vec![0xA5; T::SIZE];
        record.encode(&mut Writer::new(&mut bytes));
        bytes
    }

    #[test]
    fn run_spans_short_gaps() {
        let mut runs = Vec::new();
        encode_runs(&[0; 12], &[0, 0, 1, 0, 0, 2, 0, 0, 0, 0, 0, 3], &mut runs);
        assert_eq!(runs, [2, 4, 1, 0, 0, 2, 5, 1, 3]);
    }

    #[test]
    fn small_change_takes_few_bytes() {
        let codec = Codec::new(ExternalInputs::STRUCT);
        let mut was = ExternalInputs::default();
        was.devices.resolvers.counts = [65_535; 6];
        let mut is = was;
        is.devices.resolvers.counts[2] += 1;
        is.devices.joystick.x -= 1;
        let mut delta = Vec::new();
        codec.encode(&image(&was), &image(&is), &mut delta);
        assert_eq!(delta.len(), 5, "{delta:?}");
        assert_eq!((delta[0], delta[3], delta[4]), (2, zigzag(1) as u8, zigzag(-1) as u8));
    }

    #[test]
    fn numbers_of_every_width_round_trip_with_wrap_around() {
        let codec = Codec::new(CommonMemory::STRUCT);
        let (mut was, mut is) = (vec![0xFF; codec.size()], vec![0x80; codec.size()]);
        for _ in 0..2 {
            let mut delta = Vec::new();
            codec.encode(&was, &is, &mut delta);
            let mut image = was.clone();
            assert!(codec.apply(&delta, &mut image));
            assert!(image == is);
            std::mem::swap(&mut was, &mut is);
        }
    }

    #[test]
    fn delta_of_another_layout_is_refused() {
        let codec = Codec::new(ExternalInputs::STRUCT);
        let mut image = vec![0; codec.size()];
        assert!(!codec.apply(&[], &mut image), "no count");
        assert!(!codec.apply(&[0, 1], &mut image), "bytes left over");
        assert!(!codec.apply(&[1, 0], &mut image), "no value");
        assert!(!codec.apply(&[1, 0xFF, 0x7F, 2], &mut image), "beyond the last field");
        assert!(!codec.apply(&[0xFF; 30], &mut image), "numbers that overflow");
        assert!(!codec.apply(&[0xFF, 0xFF, 0xFF, 0x7F, 1], &mut image), "more fields than there are");
    }

    proptest! {
        #[test]
        fn encoded_image_round_trips(
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..60),
        ) {
            for record in [CommonMemory::STRUCT, LadderState::STRUCT] {
                let codec = Codec::new(record);
                let from = vec![0; codec.size()];
                let mut to = from.clone();
                for (at, byte) in &changes {
                    let at = at.index(to.len());
                    to[at] = *byte;
                }
                let mut delta = Vec::new();
                codec.encode(&from, &to, &mut delta);
                let mut image = from;
                prop_assert!(codec.apply(&delta, &mut image));
                prop_assert_eq!(image, to);
            }
        }

        #[test]
        fn any_bytes_decode_without_panic(delta in prop::collection::vec(any::<u8>(), 0..200)) {
            let codec = Codec::new(ExternalInputs::STRUCT);
            let _ = codec.apply(&delta, &mut vec![0; codec.size()]);
        }
    }
}
