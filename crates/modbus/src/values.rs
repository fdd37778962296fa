//! Registers and bits, in frames and in memory.

use core::fmt;

use crate::Error;

/// Registers: in a frame (big-endian, AP 4.2), or in memory.
#[derive(Clone, Copy)]
pub struct Words<'a>(Source<'a>);

#[derive(Clone, Copy)]
enum Source<'a> {
    Frame(&'a [[u8; 2]]),
    Memory(&'a [u16]),
}

impl<'a> Words<'a> {
    /// Registers in memory.
    #[must_use]
    pub const fn new(words: &'a [u16]) -> Self {
        Self(Source::Memory(words))
    }

    /// Registers in a frame; an odd last byte is ignored.
    pub(crate) fn in_frame(bytes: &'a [u8]) -> Self {
        Self(Source::Frame(bytes.as_chunks().0))
    }

    /// Number of registers.
    #[must_use]
    pub const fn len(&self) -> usize {
        match self.0 {
            Source::Frame(pairs) => pairs.len(),
            Source::Memory(words) => words.len(),
        }
    }

    /// True if there are no registers.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The register with an index.
    #[must_use]
    pub fn get(&self, index: usize) -> Option<u16> {
        match self.0 {
            Source::Frame(pairs) => pairs.get(index).map(|pair| u16::from_be_bytes(*pair)),
            Source::Memory(words) => words.get(index).copied(),
        }
    }

    /// The registers in order.
    pub fn iter(self) -> impl Iterator<Item = u16> + 'a {
        (0..self.len()).filter_map(move |index| self.get(index))
    }

    /// Copies the registers to the beginning of `place`, as many as fit.
    pub fn copy_to(self, place: &mut [u16]) {
        for (slot, word) in place.iter_mut().zip(self.iter()) {
            *slot = word;
        }
    }
}

impl PartialEq for Words<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}

impl Eq for Words<'_> {}

impl fmt::Debug for Words<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

/// Bits, eight per byte: the first one is the lowest bit of the first byte (AP 6.1).
#[derive(Clone, Copy)]
pub struct Bits<'a> {
    bytes: &'a [u8],
    count: usize,
}

pub(crate) const fn bytes_of_bits(count: usize) -> usize {
    count.div_ceil(8)
}

impl<'a> Bits<'a> {
    /// The first `count` bits of `bytes`. Errors: [`Error::BadSize`] if there are fewer bytes.
    pub fn new(bytes: &'a [u8], count: usize) -> Result<Self, Error> {
        let expected = bytes_of_bits(count);
        let found = bytes.len();
        bytes.get(..expected).map(|bytes| Self { bytes, count }).ok_or(Error::BadSize { expected, found })
    }

    /// Packs bits into the beginning of `buffer`. Errors: [`Error::NoRoom`] if `buffer` is too small.
    pub fn pack(bits: impl IntoIterator<Item = bool>, buffer: &'a mut [u8]) -> Result<Self, Error> {
        let mut count = 0_usize;
        for bit in bits {
            let (index, mask) = place(count);
            let byte = buffer.get_mut(index).ok_or(Error::NoRoom { needed: index.saturating_add(1) })?;
            let kept = if mask == 1 { 0 } else { *byte };
            *byte = if bit { kept | mask } else { kept };
            count = count.saturating_add(1);
        }
        Self::new(buffer, count)
    }

    /// Number of bits.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.count
    }

    /// True if there are no bits.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The bit with an index.
    #[must_use]
    pub fn get(&self, index: usize) -> Option<bool> {
        let (byte, mask) = place(index);
        let byte = self.bytes.get(byte).filter(|_| index < self.count)?;
        Some(byte & mask != 0)
    }

    /// The bits in order.
    pub fn iter(self) -> impl Iterator<Item = bool> + 'a {
        (0..self.count).filter_map(move |index| self.get(index))
    }
}

const fn place(index: usize) -> (usize, u8) {
    let mask = match index % 8 {
        0 => 0x01,
        1 => 0x02,
        2 => 0x04,
        3 => 0x08,
        4 => 0x10,
        5 => 0x20,
        6 => 0x40,
        _ => 0x80,
    };
    (index / 8, mask)
}

impl PartialEq for Bits<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.iter().eq(other.iter())
    }
}

impl Eq for Bits<'_> {}

impl fmt::Debug for Bits<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.iter().map(u8::from)).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_frame_and_memory_are_equal() {
        let frame = Words::in_frame(&[0x02, 0x2B, 0x00, 0x64, 0xFF]);
        assert_eq!(frame, Words::new(&[0x022B, 0x0064]));
        assert_ne!(frame, Words::new(&[0x022B]));
        assert_eq!((frame.len(), frame.get(1), frame.get(2)), (2, Some(100), None));
        let mut place = [0xA5A5; 3];
        frame.copy_to(&mut place);
        assert_eq!(place, [0x022B, 0x0064, 0xA5A5]);
    }

    #[test]
    fn bits_are_packed_from_the_lowest() {
        let bits = [true, false, true, true, false, false, true, true, true, false];
        let mut buffer = [0xA5; 3];
        assert_eq!(Bits::pack(bits, &mut buffer).unwrap(), Bits::new(&[0xCD, 0x01], 10).unwrap());
        assert_eq!(buffer, [0xCD, 0x01, 0xA5]);
        let packed = Bits::new(&[0xCD, 0xFF], 10).unwrap();
        assert_eq!((packed.get(1), packed.get(9), packed.get(10)), (Some(false), Some(true), None));
        assert_eq!(Bits::pack(bits, &mut [0; 1]), Err(Error::NoRoom { needed: 2 }));
        assert_eq!(Bits::new(&[0], 9), Err(Error::BadSize { expected: 2, found: 1 }));
    }
}
