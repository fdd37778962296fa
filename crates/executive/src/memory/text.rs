//! A short text in shared memory: the text of a lamp, a screen or a line of a job.

use std::fmt;

use rcs_core::{
    Plain,
    plain::{DecodeError, Reader, Schema, Writer},
};

/// At most `N` printable ASCII characters, including blanks, padded with zeros.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Text<const N: usize>([u8; N]);

impl<const N: usize> Text<N> {
    /// The first `N` characters; one that is not printable ASCII becomes `?`, a line break a blank.
    #[must_use]
    pub fn clipped(text: &str) -> Self {
        let mut bytes = [0; N];
        for (slot, letter) in bytes.iter_mut().zip(text.chars()) {
            *slot = match letter {
                '\n' | '\t' => b' ',
                letter if letter == ' ' || letter.is_ascii_graphic() => u8::try_from(letter).unwrap_or(b'?'),
                _ => b'?',
            };
        }
        Self(bytes)
    }

    #[must_use]
    pub fn as_str(&self) -> &str {
        let end = self.0.iter().position(|byte| *byte == 0).unwrap_or(N);
        self.0.get(..end).and_then(|bytes| std::str::from_utf8(bytes).ok()).unwrap_or_default()
    }
}

impl<const N: usize> Default for Text<N> {
    fn default() -> Self {
        Self::ZERO
    }
}

impl<const N: usize> fmt::Debug for Text<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

impl<const N: usize> fmt::Display for Text<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

impl<const N: usize> Plain for Text<N> {
    const SCHEMA: Schema = Schema::Text(N);
    const ZERO: Self = Self([0; N]);

    fn encode(&self, w: &mut Writer<'_>) {
        w.put(&self.0);
    }

    fn decode(r: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let bytes: [u8; N] = Plain::decode(r)?;
        let text = Self(bytes);
        let end = text.as_str().len();
        let (letters, rest) = bytes.split_at(end);
        let legal = letters.iter().all(|byte| *byte == b' ' || byte.is_ascii_graphic());
        if legal && rest.iter().all(|byte| *byte == 0) { Ok(text) } else { Err(DecodeError::BadName) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rcs_core::plain::{from_bytes, to_bytes};

    #[test]
    fn a_text_is_cut_and_its_characters_are_printable() {
        assert_eq!(Text::<8>::clipped("tray \u{b0}C 12").as_str(), "tray ?C ");
        assert_eq!(Text::<8>::clipped("a\nb").as_str(), "a b");
        assert_eq!(Text::<8>::default().as_str(), "");
    }

    #[test]
    fn only_valid_bytes_decode_as_text() {
        let text = Text::<8>::clipped("MOVE 4");
        assert_eq!(from_bytes::<Text<8>>(&to_bytes::<8, _>(&text)), Ok(text));
        for bad in [*b"MOV\x01\0\0\0\0", *b"MOV\0E\0\0\0", [0xC3, 0xA9, 0, 0, 0, 0, 0, 0]] {
            assert_eq!(from_bytes::<Text<8>>(&bad), Err(DecodeError::BadName), "{bad:?}");
        }
    }
}
