//! The fingerprint of a run: FNV-1a, 64 bits, over the byte images of all output buffers of all ticks in process order.
//!
//! It holds nothing that depends on time spent or on how processes are spread over boards, so equal runs have equal
//! digests wherever and however they ran.

use crate::record::{Field, Writer};

/// A running FNV-1a hash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest(u64);

impl Digest {
    const OFFSET: u64 = 0xCBF2_9CE4_8422_2325;
    const PRIME: u64 = 0x0000_0100_0000_01B3;

    /// The digest of nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self(Self::OFFSET)
    }

    /// Add bytes.
    pub fn add(&mut self, bytes: &[u8]) {
        self.0 = bytes.iter().fold(self.0, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(Self::PRIME));
    }

    /// Add a record through a scratch buffer that is at least as large as its image.
    pub fn add_record<T: Field>(&mut self, record: &T, scratch: &mut [u8]) {
        let Some(image) = scratch.get_mut(..T::SIZE) else { return };
        record.encode(&mut Writer::new(image));
        self.add(image);
    }

    /// The hash.
    #[must_use]
    pub const fn value(self) -> u64 {
        self.0
    }
}

impl Default for Digest {
    fn default() -> Self {
        Self::new()
    }
}

impl core::fmt::Display for Digest {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_fnv_1a() {
        let mut digest = Digest::new();
        assert_eq!(digest.to_string(), "cbf29ce484222325");
        digest.add(b"foobar");
        assert_eq!(digest.value(), 0x8594_4171_f739_67e8);
    }
}
