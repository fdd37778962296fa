//! A reader and a writer over byte slices. Words are big-endian (AP 4.2).

use crate::Error;

/// Reads a frame from its beginning.
#[derive(Clone, Copy)]
pub struct Reader<'a> {
    whole: &'a [u8],
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self { whole: bytes, rest: bytes }
    }

    pub fn byte(&mut self) -> Result<u8, Error> {
        self.array().map(|[byte]| byte)
    }

    pub fn word(&mut self) -> Result<u16, Error> {
        self.array().map(u16::from_be_bytes)
    }

    pub fn take(&mut self, length: usize) -> Result<&'a [u8], Error> {
        let (taken, rest) = self.rest.split_at_checked(length).ok_or_else(|| self.too_short(length))?;
        self.rest = rest;
        Ok(taken)
    }

    /// Checks that all bytes were read.
    pub fn finish(self) -> Result<(), Error> {
        if self.rest.is_empty() {
            return Ok(());
        }
        let found = self.whole.len();
        Err(Error::BadSize { expected: found.saturating_sub(self.rest.len()), found })
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Error> {
        let (taken, rest) = self.rest.split_first_chunk().ok_or_else(|| self.too_short(N))?;
        self.rest = rest;
        Ok(*taken)
    }

    fn too_short(&self, length: usize) -> Error {
        let found = self.whole.len();
        Error::BadSize { expected: found.saturating_sub(self.rest.len()).saturating_add(length), found }
    }
}

/// Writes a frame from its beginning.
pub struct Writer<'a> {
    buffer: &'a mut [u8],
    written: usize,
}

impl<'a> Writer<'a> {
    pub const fn new(buffer: &'a mut [u8]) -> Self {
        Self { buffer, written: 0 }
    }

    pub const fn written(&self) -> usize {
        self.written
    }

    pub fn byte(&mut self, byte: u8) -> Result<(), Error> {
        self.bytes(&[byte])
    }

    pub fn word(&mut self, word: u16) -> Result<(), Error> {
        self.bytes(&word.to_be_bytes())
    }

    pub fn bytes(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let end = self.written.saturating_add(bytes.len());
        let place = self.buffer.get_mut(self.written..end).ok_or(Error::NoRoom { needed: end })?;
        place.copy_from_slice(bytes);
        self.written = end;
        Ok(())
    }
}
