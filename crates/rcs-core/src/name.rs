//! Fixed-size names, as the manual's 10-, 12- and 16-character strings (V.1.2, VII).

use core::{fmt, str::FromStr};

use crate::{
    Plain,
    plain::{DecodeError, Reader, Schema, Writer},
};

/// A name: at most `N` printable ASCII characters, no blanks, zero-filled, so that equal names have equal bytes.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct Name<const N: usize>([u8; N]);

/// Names of task data: at most ten characters (VII).
pub type Name10 = Name<10>;
/// Object names and the fields of a Task command: at most sixteen characters (VII, V.4.2).
pub type Name16 = Name<16>;

/// Reason why a text is not a [`Name`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NameError {
    /// Too many characters.
    TooLong {
        /// Characters allowed.
        allowed: usize,
        /// Characters found.
        found: usize,
    },
    /// A blank, or a character that is not printable ASCII.
    BadCharacter {
        /// Byte position of the character, from 0.
        position: usize,
    },
}

impl fmt::Display for NameError {
    #[inline]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooLong { allowed, found } => {
                write!(f, "a name of at most {allowed} characters was expected, this one has {found}")
            }
            Self::BadCharacter { position } => {
                write!(
                    f,
                    "a name has printable characters without blanks, character {} is not",
                    position.saturating_add(1)
                )
            }
        }
    }
}

impl core::error::Error for NameError {}

impl<const N: usize> Name<N> {
    /// The empty name, a null field.
    pub const EMPTY: Self = Self([0; N]);

    /// Makes a name from text. Errors: the text is longer than `N`, has blanks, or is not printable ASCII.
    #[inline]
    pub const fn new(text: &str) -> Result<Self, NameError> {
        let from = text.as_bytes();
        if from.len() > N {
            return Err(NameError::TooLong { allowed: N, found: from.len() });
        }
        let mut bytes = [0; N];
        let (mut rest_from, mut rest_to, mut position) = (from, bytes.as_mut_slice(), 0_usize);
        while let (Some((byte, more_from)), Some((slot, more_to))) =
            (rest_from.split_first(), rest_to.split_first_mut())
        {
            if !byte.is_ascii_graphic() {
                return Err(NameError::BadCharacter { position });
            }
            *slot = *byte;
            (rest_from, rest_to, position) = (more_from, more_to, position.saturating_add(1));
        }
        Ok(Self(bytes))
    }

    /// Keeps the first `N` characters (SPECNOTES.md, contradiction 22) and replaces those that no name can have by `?`.
    #[must_use]
    #[inline]
    pub fn clipped(text: &str) -> Self {
        let mut bytes = [0; N];
        for (slot, byte) in bytes.iter_mut().zip(text.bytes()) {
            *slot = if byte.is_ascii_graphic() { byte } else { b'?' };
        }
        Self(bytes)
    }

    /// The text of the name.
    #[must_use]
    #[inline]
    pub fn as_str(&self) -> &str {
        let end = self.0.iter().position(|&b| b == 0).unwrap_or(N);
        self.0.get(..end).and_then(|bytes| core::str::from_utf8(bytes).ok()).unwrap_or("")
    }

    /// True if the name is null.
    #[must_use]
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.0.first().is_none_or(|&b| b == 0)
    }

    /// The bytes, zero-filled at the end.
    #[must_use]
    #[inline]
    pub const fn bytes(&self) -> &[u8; N] {
        &self.0
    }
}

impl<const N: usize> Default for Name<N> {
    #[inline]
    fn default() -> Self {
        Self::EMPTY
    }
}

impl<const N: usize> FromStr for Name<N> {
    type Err = NameError;

    #[inline]
    fn from_str(text: &str) -> Result<Self, NameError> {
        Self::new(text)
    }
}

impl<const N: usize> fmt::Display for Name<N> {
    #[inline]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.as_str())
    }
}

impl<const N: usize> fmt::Debug for Name<N> {
    #[inline]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

impl<const N: usize> Plain for Name<N> {
    const SCHEMA: Schema = Schema::Text(N);
    const ZERO: Self = Self::EMPTY;

    #[inline]
    fn encode(&self, w: &mut Writer<'_>) {
        w.put(&self.0);
    }

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let bytes: [u8; N] = r.take()?;
        let length = bytes.iter().position(|&b| b == 0).unwrap_or(N);
        let well_formed =
            bytes.iter().enumerate().all(|(i, b)| if i < length { b.is_ascii_graphic() } else { *b == 0 });
        if well_formed { Ok(Self(bytes)) } else { Err(DecodeError::BadName) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn name_returns_its_text() {
        let name = Name10::new("LK-GRP-FX1").unwrap();
        assert_eq!(name.as_str(), "LK-GRP-FX1");
        assert_eq!(Name10::new("...").unwrap().to_string(), "...");
        assert!(Name10::EMPTY.is_empty());
    }

    #[test]
    fn invalid_names_are_refused_with_the_reason() {
        assert_eq!(Name10::new("TRNG-SECTORS"), Err(NameError::TooLong { allowed: 10, found: 12 }));
        assert_eq!(Name10::new("UNIT 1"), Err(NameError::BadCharacter { position: 4 }));
        assert_eq!(Name10::clipped("RELEASE-TOOL").as_str(), "RELEASE-TO");
    }

    #[test]
    fn a_name_with_bytes_after_its_end_is_refused() {
        let mut r = Reader::new(b"AB\0C\0\0\0\0\0\0");
        assert_eq!(Name10::decode(&mut r), Err(DecodeError::BadName));
    }
}
