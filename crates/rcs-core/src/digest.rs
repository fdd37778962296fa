//! The digest of a run: 64 bits over the byte images of all output buffers of all ticks in process order.
//!
//! Each step mixes eight bytes as a little-endian word: exclusive or, multiplication, and folding of the upper half
//! into the lower, which a multiplication does not reach. It is a bijection of the hash, so no later step can hide a
//! difference. The digest detects accidental differences, not manipulation.
//!
//! Each image is hashed separately, its words over four lanes, whose multiplications a processor overlaps. Several
//! processors can compute the hashes that the digest chains. Equal runs have equal digests on every machine and with
//! any boards.

use crate::{Plain, plain::Writer};

const LANES: usize = 4; // parallel chains per image

/// A running hash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest(u64);

impl Digest {
    const START: u64 = 0xCBF2_9CE4_8422_2325;
    const FACTOR: u64 = 0x9E37_79B9_7F4A_7C15; // 2^64 divided by the golden ratio: odd, without a bit pattern

    /// The digest of an empty run.
    #[must_use]
    #[inline]
    pub const fn new() -> Self {
        Self(Self::START)
    }

    /// Add bytes and their number.
    #[inline]
    pub fn add(&mut self, bytes: &[u8]) {
        self.add_hash(hash(bytes));
    }

    /// Add bytes by their [`hash`].
    #[inline]
    pub const fn add_hash(&mut self, hash: u64) {
        self.0 = mix(self.0, hash);
    }

    /// Add a record through a scratch buffer that is at least as large as its image.
    #[inline]
    pub fn add_record<T: Plain>(&mut self, record: &T, scratch: &mut [u8]) {
        let Some(image) = scratch.get_mut(..T::SIZE) else { return };
        record.encode(&mut Writer::new(image));
        self.add(image);
    }

    /// The hash.
    #[must_use]
    #[inline]
    pub const fn value(self) -> u64 {
        self.0
    }
}

/// The hash of bytes and their number.
#[must_use]
#[inline]
pub fn hash(bytes: &[u8]) -> u64 {
    let mut lanes = [Digest::START; LANES];
    let (rounds, rest) = bytes.as_chunks::<{ 8 * LANES }>();
    let mut last = [0; 8 * LANES];
    last.iter_mut().zip(rest).for_each(|(slot, byte)| *slot = *byte);
    for round in rounds.iter().chain([&last]) {
        let (words, _) = round.as_chunks::<8>();
        for (lane, word) in lanes.iter_mut().zip(words) {
            *lane = mix(*lane, u64::from_le_bytes(*word));
        }
    }
    let length = u64::try_from(bytes.len()).unwrap_or(u64::MAX);
    lanes.into_iter().fold(mix(Digest::START, length), mix)
}

/// A bijection of both hash and word.
#[inline]
const fn mix(hash: u64, word: u64) -> u64 {
    let product = (hash ^ word).wrapping_mul(Digest::FACTOR);
    product ^ (product >> 32)
}

impl Default for Digest {
    #[inline]
    fn default() -> Self {
        Self::new()
    }
}

impl core::fmt::Display for Digest {
    #[inline]
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(bytes: &[u8]) -> u64 {
        let mut digest = Digest::new();
        digest.add(bytes);
        digest.value()
    }

    #[test]
    fn every_bit_of_a_word_reaches_both_halves() {
        let base = of(&[0; 80]);
        for bit in 0..640 {
            let mut bytes = [0_u8; 80];
            bytes[bit / 8] = 1 << (bit % 8);
            let changed = of(&bytes) ^ base;
            assert!(changed & 0xFFFF_FFFF != 0 && changed >> 32 != 0, "bit {bit}: {changed:016x}");
        }
    }

    #[test]
    fn number_of_bytes_changes_the_hash() {
        let all: Vec<u64> = (0..70).map(|length| of(&vec![0; length])).collect();
        for (a, first) in all.iter().enumerate() {
            assert!(all.iter().skip(a + 1).all(|second| second != first));
        }
    }

    #[test]
    fn digest_is_equal_on_every_machine() {
        assert_eq!(Digest::new().to_string(), "cbf29ce484222325");
        // Computed from the module comment in another language.
        assert_eq!(of(b"the quick brown fox"), 0x34E8_6243_F9A9_069E);
        let all: Vec<u8> = (0..100).collect();
        assert_eq!(of(&all), 0xC062_4FA6_2055_D507);
    }
}
