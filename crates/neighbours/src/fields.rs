//! Fixed fields of a mailbox's data, as fixed-field interfaces have them (V.4.2, VI.7.2): texts with blanks behind them,
//! integers of two, four or eight bytes, low byte first. Nothing here allocates.

use std::fmt::{self, Write as _};

use rcs_core::name::{Name, Name16};

/// What stands behind a text that is shorter than its field.
const BLANK: u8 = b' ';

/// Why a field cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldError {
    /// The data end before the field does.
    End {
        /// The field, in the manual's words.
        field: &'static str,
    },
    /// A character that no name has.
    Character {
        /// The field, in the manual's words.
        field: &'static str,
        /// Where the character stands in the data, bytes from 0.
        at: usize,
        /// The character.
        found: u8,
    },
    /// A word that is none of the field's.
    Word {
        /// The field, in the manual's words.
        field: &'static str,
        /// The word.
        found: Name16,
    },
    /// A code that is none of the field's.
    Code {
        /// The field, in the manual's words.
        field: &'static str,
        /// The code.
        found: u16,
    },
}

impl fmt::Display for FieldError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::End { field } => write!(f, "the data end before {field} does"),
            Self::Character { field, at, found } => {
                write!(
                    f,
                    "printable characters and blanks behind them were expected for {field}, found {found:02X} at byte {at}"
                )
            }
            Self::Word { field, found } => write!(f, "{found} is no word of {field}"),
            Self::Code { field, found } => write!(f, "{found} is no code of {field}"),
        }
    }
}

impl std::error::Error for FieldError {}

/// An integer that two bytes cannot hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("an integer of two bytes was expected for {field}, found {found}")]
pub struct RangeError {
    /// The field, in the manual's words.
    pub field: &'static str,
    /// The integer.
    pub found: i32,
}

/// Puts fields into data of `N` bytes, one behind the other.
#[derive(Debug)]
pub struct Packer<const N: usize> {
    bytes: [u8; N],
    at: usize,
}

impl<const N: usize> Default for Packer<N> {
    fn default() -> Self {
        Self { bytes: [BLANK; N], at: 0 }
    }
}

impl<const N: usize> Packer<N> {
    fn put(&mut self, bytes: &[u8]) {
        self.bytes[self.at..self.at + bytes.len()].copy_from_slice(bytes);
        self.at += bytes.len();
    }

    /// A text in `width` bytes; what does not fit is cut off.
    pub fn text(&mut self, width: usize, text: &dyn fmt::Display) {
        let field = &mut self.bytes[self.at..self.at + width];
        field.fill(BLANK);
        // A text that is cut off is what was wanted.
        let _ = write!(Clipped { rest: field }, "{text}");
        self.at += width;
    }

    /// An unsigned integer.
    pub fn word(&mut self, value: u16) {
        self.put(&value.to_le_bytes());
    }

    /// A signed integer.
    ///
    /// # Errors
    /// [`RangeError`] if two bytes cannot hold it.
    pub fn integer(&mut self, field: &'static str, value: i32) -> Result<(), RangeError> {
        let value = i16::try_from(value).map_err(|_| RangeError { field, found: value })?;
        self.put(&value.to_le_bytes());
        Ok(())
    }

    /// A signed integer; what two bytes cannot hold is held at the end of their range.
    pub fn saturated(&mut self, value: i32) {
        let range = i32::from(i16::MIN)..=i32::from(i16::MAX);
        let value = i16::try_from(value.clamp(*range.start(), *range.end())).unwrap_or_default();
        self.put(&value.to_le_bytes());
    }

    /// An unsigned integer of four bytes.
    pub fn long(&mut self, value: u32) {
        self.put(&value.to_le_bytes());
    }

    /// A signed integer of four bytes.
    pub fn long_integer(&mut self, value: i32) {
        self.put(&value.to_le_bytes());
    }

    /// An unsigned integer of eight bytes.
    pub fn quad(&mut self, value: u64) {
        self.put(&value.to_le_bytes());
    }

    /// A flag: 1 or 0, in two bytes.
    pub fn flag(&mut self, value: bool) {
        self.word(u16::from(value));
    }

    /// Bytes as they are.
    pub fn raw(&mut self, bytes: &[u8]) {
        self.put(bytes);
    }

    /// All `N` bytes.
    ///
    /// # Panics
    /// If the fields are not as many bytes as the data has: a mistake in the layout.
    #[must_use]
    pub fn finish(self) -> [u8; N] {
        assert_eq!(self.at, N, "the fields of a layout fill it");
        self.bytes
    }
}

/// Writes as much as there is room for.
struct Clipped<'a> {
    rest: &'a mut [u8],
}

impl fmt::Write for Clipped<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            let (slot, rest) = std::mem::take(&mut self.rest).split_first_mut().ok_or(fmt::Error)?;
            *slot = if byte == BLANK || byte.is_ascii_graphic() { byte } else { b'?' };
            self.rest = rest;
        }
        Ok(())
    }
}

/// Takes fields out of data, one behind the other.
#[derive(Clone, Copy, Debug)]
pub struct Unpacker<'a> {
    data: &'a [u8],
    at: usize,
}

impl<'a> Unpacker<'a> {
    /// At the first field of `data`.
    #[must_use]
    pub const fn new(data: &'a [u8]) -> Self {
        Self { data, at: 0 }
    }

    /// So many bytes as they are.
    ///
    /// # Errors
    /// [`FieldError::End`].
    pub fn raw(&mut self, field: &'static str, width: usize) -> Result<&'a [u8], FieldError> {
        let bytes = self.data.get(self.at..self.at + width).ok_or(FieldError::End { field })?;
        self.at += width;
        Ok(bytes)
    }

    /// A name, with blanks or zeros behind it.
    ///
    /// # Errors
    /// [`FieldError`] if the field holds anything else.
    pub fn name<const W: usize>(&mut self, field: &'static str) -> Result<Name<W>, FieldError> {
        let start = self.at;
        let bytes = self.raw(field, W)?;
        let length = bytes.iter().rposition(|&byte| byte != BLANK && byte != 0).map_or(0, |last| last + 1);
        if let Some(bad) = bytes[..length].iter().position(|byte| !byte.is_ascii_graphic()) {
            return Err(FieldError::Character { field, at: start + bad, found: bytes[bad] });
        }
        Ok(Name::clipped(str::from_utf8(&bytes[..length]).unwrap_or_default()))
    }

    /// A text of any printable characters, without the blanks behind it.
    ///
    /// # Errors
    /// [`FieldError`] if the field holds anything else.
    pub fn text(&mut self, field: &'static str, width: usize) -> Result<&'a str, FieldError> {
        let start = self.at;
        let bytes = self.raw(field, width)?;
        let length = bytes.iter().rposition(|&byte| byte != BLANK && byte != 0).map_or(0, |last| last + 1);
        if let Some(bad) = bytes[..length].iter().position(|&byte| byte != BLANK && !byte.is_ascii_graphic())
        {
            return Err(FieldError::Character { field, at: start + bad, found: bytes[bad] });
        }
        Ok(str::from_utf8(&bytes[..length]).unwrap_or_default())
    }

    /// An unsigned integer.
    ///
    /// # Errors
    /// [`FieldError::End`].
    pub fn word(&mut self, field: &'static str) -> Result<u16, FieldError> {
        let bytes = self.raw(field, 2)?;
        Ok(u16::from_le_bytes([bytes[0], bytes[1]]))
    }

    /// A signed integer.
    ///
    /// # Errors
    /// [`FieldError::End`].
    pub fn integer(&mut self, field: &'static str) -> Result<i32, FieldError> {
        let bytes = self.raw(field, 2)?;
        Ok(i32::from(i16::from_le_bytes([bytes[0], bytes[1]])))
    }

    /// The next `N` bytes as they are.
    fn chunk<const N: usize>(&mut self, field: &'static str) -> Result<[u8; N], FieldError> {
        self.raw(field, N)?.try_into().map_err(|_| FieldError::End { field })
    }

    /// An unsigned integer of four bytes.
    ///
    /// # Errors
    /// [`FieldError::End`].
    pub fn long(&mut self, field: &'static str) -> Result<u32, FieldError> {
        self.chunk(field).map(u32::from_le_bytes)
    }

    /// A signed integer of four bytes.
    ///
    /// # Errors
    /// [`FieldError::End`].
    pub fn long_integer(&mut self, field: &'static str) -> Result<i32, FieldError> {
        self.chunk(field).map(i32::from_le_bytes)
    }

    /// An unsigned integer of eight bytes.
    ///
    /// # Errors
    /// [`FieldError::End`].
    pub fn quad(&mut self, field: &'static str) -> Result<u64, FieldError> {
        self.chunk(field).map(u64::from_le_bytes)
    }

    /// An unsigned integer of two bytes that is at most 255.
    ///
    /// # Errors
    /// [`FieldError`] if it is more, or the data end.
    pub fn byte(&mut self, field: &'static str) -> Result<u8, FieldError> {
        let found = self.word(field)?;
        u8::try_from(found).map_err(|_| FieldError::Code { field, found })
    }

    /// A flag of two bytes: 1 or 0.
    ///
    /// # Errors
    /// [`FieldError`] if it is neither, or the data end.
    pub fn flag(&mut self, field: &'static str) -> Result<bool, FieldError> {
        match self.word(field)? {
            0 => Ok(false),
            1 => Ok(true),
            found => Err(FieldError::Code { field, found }),
        }
    }
}

/// The command number of a mailbox: the manual's integers have two bytes, the controller counts with four. From 65535 it goes to
/// 1, since 0 means none.
#[must_use]
pub fn command_number(number: u32) -> u16 {
    let wrapped = number.checked_sub(1).map_or(0, |before| before % u32::from(u16::MAX) + 1);
    u16::try_from(wrapped).unwrap_or_default()
}

/// The command number that comes after another one.
#[must_use]
pub fn successor(number: u16) -> u16 {
    number.checked_add(1).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_packed_is_unpacked() {
        let mut packer = Packer::<26>::default();
        packer.text(16, &Name16::new("LINKBAR1").unwrap());
        packer.word(0x1234);
        packer.integer("grip", -2).unwrap();
        packer.text(6, &"too long for it");
        let bytes = packer.finish();
        assert_eq!(&bytes, b"LINKBAR1        \x34\x12\xFE\xFFtoo lo");
        let mut fields = Unpacker::new(&bytes);
        assert_eq!(fields.name::<16>("obj").unwrap().as_str(), "LINKBAR1");
        assert_eq!(fields.word("number"), Ok(0x1234));
        assert_eq!(fields.integer("grip"), Ok(-2));
        assert_eq!(fields.text("words", 6), Ok("too lo"));
        assert_eq!(fields.word("more"), Err(FieldError::End { field: "more" }));
    }

    #[test]
    fn zeros_behind_a_name_are_blanks_and_anything_in_it_is_named() {
        let name = |bytes: &[u8; 4]| Unpacker::new(bytes).name::<4>("obj");
        assert_eq!(name(b"AB\0 ").unwrap().as_str(), "AB");
        assert!(name(b"\0\0\0\0").unwrap().is_empty());
        assert_eq!(name(b"A B "), Err(FieldError::Character { field: "obj", at: 1, found: b' ' }));
        let error = name(b"AB\x07C").unwrap_err();
        assert!(error.to_string().ends_with("for obj, found 07 at byte 2"), "{error}");
    }

    #[test]
    fn longer_integers_and_flags_come_back() {
        let mut packer = Packer::<20>::default();
        packer.long(0x0102_0304);
        packer.long_integer(-2);
        packer.quad(0x0102_0304_0506_0708);
        packer.flag(true);
        packer.word(256);
        let bytes = packer.finish();
        assert_eq!(
            bytes,
            *b"\x04\x03\x02\x01\xFE\xFF\xFF\xFF\x08\x07\x06\x05\x04\x03\x02\x01\x01\x00\x00\x01"
        );
        let mut fields = Unpacker::new(&bytes);
        assert_eq!((fields.long("a"), fields.long_integer("b")), (Ok(0x0102_0304), Ok(-2)));
        assert_eq!((fields.quad("c"), fields.flag("d")), (Ok(0x0102_0304_0506_0708), Ok(true)));
        let rest = fields;
        assert_eq!(fields.byte("e"), Err(FieldError::Code { field: "e", found: 256 }));
        fields = rest;
        assert_eq!(fields.flag("e"), Err(FieldError::Code { field: "e", found: 256 }));
        assert_eq!(fields.long("f"), Err(FieldError::End { field: "f" }));
    }

    #[test]
    fn integers_have_two_bytes() {
        let mut packer = Packer::<2>::default();
        assert_eq!(packer.integer("sector", 40_000), Err(RangeError { field: "sector", found: 40_000 }));
        packer.saturated(-40_000);
        assert_eq!(packer.finish(), i16::MIN.to_le_bytes());
    }

    #[test]
    fn command_numbers_run_round_without_zero() {
        let numbers = [0, 1, 65_535, 65_536, 131_070, 131_071].map(command_number);
        assert_eq!(numbers, [0, 1, 65_535, 1, 65_535, 1]);
        assert_eq!([1, 65_535].map(successor), [2, 1]);
    }
}
