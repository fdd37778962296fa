//! Images of one tick as their difference from the tick before.
//!
//! In a quiet tick a few bytes of some thousand change. A delta is a list of runs, each *bytes to skip*,
//! *bytes that follow* (both as varints) and those bytes. A full image is a delta from zeros, so that long
//! zero runs cost two bytes there too.

use crate::proto::wire::{put_varint, take_varint};

/// Equal bytes that end a run: a shorter gap costs more as a new run than as bytes.
const GAP: usize = 4;

/// Append to `out` what turns `from` into `to`; images of one record have one length.
pub fn encode(from: &[u8], to: &[u8], out: &mut Vec<u8>) {
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

/// Turn `image` into what `delta` was made from; false if the delta does not fit the image.
#[must_use]
pub fn apply(mut delta: &[u8], image: &mut [u8]) -> bool {
    let mut at = 0_usize;
    while !delta.is_empty() {
        let run = take_varint(&mut delta).zip(take_varint(&mut delta)).and_then(|(skip, length)| {
            let start = at.checked_add(usize::try_from(skip).ok()?)?;
            let end = start.checked_add(usize::try_from(length).ok()?)?;
            let (bytes, rest) = delta.split_at_checked(end - start)?;
            image.get_mut(start..end)?.copy_from_slice(bytes);
            Some((end, rest))
        });
        let Some((end, rest)) = run else { return false };
        (at, delta) = (end, rest);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_run_goes_over_short_gaps() {
        let mut delta = Vec::new();
        encode(&[0; 12], &[0, 0, 1, 0, 0, 2, 0, 0, 0, 0, 0, 3], &mut delta);
        assert_eq!(delta, [2, 4, 1, 0, 0, 2, 5, 1, 3]);
    }

    #[test]
    fn a_delta_that_does_not_fit_is_refused() {
        let mut image = [0; 4];
        assert!(!apply(&[2, 3, 1, 1, 1], &mut image), "beyond the image");
        assert!(!apply(&[0, 3, 1], &mut image), "bytes missing");
        assert!(!apply(&[0x80], &mut image), "half a number");
        assert!(!apply(&[0xFF; 30], &mut image), "numbers that overflow");
    }

    proptest! {
        #[test]
        fn what_was_encoded_comes_back(
            from in prop::collection::vec(0_u8..3, 300),
            to in prop::collection::vec(0_u8..3, 300),
            same in prop::collection::vec(any::<bool>(), 300),
        ) {
            let to: Vec<u8> =
                from.iter().zip(&to).zip(&same).map(|((a, b), same)| if *same { *a } else { *b }).collect();
            let mut delta = Vec::new();
            encode(&from, &to, &mut delta);
            let mut image = from.clone();
            prop_assert!(apply(&delta, &mut image));
            prop_assert_eq!(image, to);
        }
    }
}
