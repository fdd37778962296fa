//! Records: the fixed-size data that processes exchange, with one definition for everything that is done with them.
//!
//! A record is written once, with [`record!`](crate::record!), and the same definition gives the plain Rust structure,
//! its byte image (field by field, little-endian, without padding), the checked way back from bytes, and a
//! [`Schema`] that recorders, viewers and the digest walk. Equal records are equal bytes, and a byte image from outside
//! becomes a record only if every name, flag and enum in it is legal.

use core::fmt;

/// What a byte image holds, as a tree of constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Schema {
    /// Unsigned, one byte.
    U8,
    /// Unsigned, two bytes.
    U16,
    /// Unsigned, four bytes.
    U32,
    /// Unsigned, eight bytes.
    U64,
    /// Signed, two bytes.
    I16,
    /// Signed, four bytes.
    I32,
    /// Floating point, eight bytes.
    F64,
    /// One byte, 0 or 1.
    Bool,
    /// A name of so many bytes, zero-filled.
    Text(usize),
    /// One byte; the code of a variant.
    Enum(&'static EnumSchema),
    /// So many of the same.
    Array(&'static Schema, usize),
    /// A record in the record.
    Record(&'static RecordSchema),
}

/// An enum in a record: its name, and the code and text of each variant.
#[derive(Debug, PartialEq)]
pub struct EnumSchema {
    /// Rust name of the enum.
    pub name: &'static str,
    /// Code and text of each variant; the text is the manual's word where it has one.
    pub variants: &'static [(u8, &'static str)],
}

/// A record: its name and fields in the order of the byte image.
#[derive(Debug, PartialEq)]
pub struct RecordSchema {
    /// Rust name of the record.
    pub name: &'static str,
    /// The fields.
    pub fields: &'static [FieldSchema],
}

/// A field of a record.
#[derive(Debug, PartialEq)]
pub struct FieldSchema {
    /// Rust name of the field.
    pub name: &'static str,
    /// What it holds.
    pub schema: Schema,
}

impl Schema {
    /// Bytes of the image.
    #[must_use]
    pub const fn size(&self) -> usize {
        match self {
            Self::U8 | Self::Bool | Self::Enum(_) => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 => 4,
            Self::U64 | Self::F64 => 8,
            Self::Text(n) => *n,
            Self::Array(of, n) => of.size().saturating_mul(*n),
            Self::Record(record) => record.size(),
        }
    }
}

impl RecordSchema {
    /// Bytes of the image.
    #[must_use]
    pub const fn size(&self) -> usize {
        let (mut rest, mut size) = (self.fields, 0_usize);
        while let Some((field, more)) = rest.split_first() {
            size = size.saturating_add(field.schema.size());
            rest = more;
        }
        size
    }
}

/// Why bytes are not a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DecodeError {
    /// Fewer bytes than the record has.
    TooShort,
    /// A name with blanks, control characters or bytes after its end.
    BadName,
    /// A flag that is neither 0 nor 1.
    BadFlag(u8),
    /// A code that no variant of the enum has.
    BadCode {
        /// Name of the enum.
        of: &'static str,
        /// The code found.
        found: u8,
    },
}

impl fmt::Display for DecodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooShort => f.write_str("the bytes end before the record does"),
            Self::BadName => f.write_str("a name holds bytes that no name can have"),
            Self::BadFlag(found) => write!(f, "a flag is 0 or 1, found {found}"),
            Self::BadCode { of, found } => write!(f, "{found} is the code of no {of}"),
        }
    }
}

impl core::error::Error for DecodeError {}

/// Puts fields into a byte image. Bytes that do not fit are counted, not written.
pub struct Writer<'a> {
    rest: &'a mut [u8],
    missing: usize,
}

impl<'a> Writer<'a> {
    /// A writer over `bytes`.
    pub const fn new(bytes: &'a mut [u8]) -> Self {
        Self { rest: bytes, missing: 0 }
    }

    /// Append `bytes`.
    pub fn put(&mut self, bytes: &[u8]) {
        let room = core::mem::take(&mut self.rest);
        match room.split_at_mut_checked(bytes.len()) {
            Some((here, rest)) => {
                here.copy_from_slice(bytes);
                self.rest = rest;
            }
            None => self.missing = self.missing.saturating_add(bytes.len()),
        }
    }

    /// Bytes that found no room.
    #[must_use]
    pub const fn missing(&self) -> usize {
        self.missing
    }
}

/// Takes fields out of a byte image.
pub struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    /// A reader over `bytes`.
    #[must_use]
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// The next `N` bytes.
    ///
    /// # Errors
    /// [`DecodeError::TooShort`] if fewer are left.
    pub fn take<const N: usize>(&mut self) -> Result<[u8; N], DecodeError> {
        let (here, rest) = self.rest.split_first_chunk::<N>().ok_or(DecodeError::TooShort)?;
        self.rest = rest;
        Ok(*here)
    }
}

/// Something that stands in a record: a number, a name, an enum, an array, a record.
pub trait Field: Copy + PartialEq {
    /// What its byte image holds.
    const SCHEMA: Schema;
    /// Bytes of the image.
    const SIZE: usize = Self::SCHEMA.size();
    /// The value before anything was written.
    const ZERO: Self;

    /// Append the image.
    fn encode(&self, w: &mut Writer<'_>);

    /// Take it back.
    ///
    /// # Errors
    /// [`DecodeError`] if the bytes are not the image of a legal value.
    fn decode(r: &mut Reader<'_>) -> Result<Self, DecodeError>;
}

macro_rules! number {
    ($($type:ty => $schema:ident, $zero:expr;)*) => {$(
        impl Field for $type {
            const SCHEMA: Schema = Schema::$schema;
            const ZERO: Self = $zero;

            fn encode(&self, w: &mut Writer<'_>) {
                w.put(&self.to_le_bytes());
            }

            fn decode(r: &mut Reader<'_>) -> Result<Self, DecodeError> {
                Ok(Self::from_le_bytes(r.take()?))
            }
        }
    )*};
}

number! {
    u8 => U8, 0;
    u16 => U16, 0;
    u32 => U32, 0;
    u64 => U64, 0;
    i16 => I16, 0;
    i32 => I32, 0;
    f64 => F64, 0.0;
}

impl Field for bool {
    const SCHEMA: Schema = Schema::Bool;
    const ZERO: Self = false;

    fn encode(&self, w: &mut Writer<'_>) {
        u8::from(*self).encode(w);
    }

    fn decode(r: &mut Reader<'_>) -> Result<Self, DecodeError> {
        match u8::decode(r)? {
            0 => Ok(false),
            1 => Ok(true),
            other => Err(DecodeError::BadFlag(other)),
        }
    }
}

impl<T: Field + 'static, const N: usize> Field for [T; N] {
    const SCHEMA: Schema = Schema::Array(&T::SCHEMA, N);
    const ZERO: Self = [T::ZERO; N];

    fn encode(&self, w: &mut Writer<'_>) {
        for item in self {
            item.encode(w);
        }
    }

    fn decode(r: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let mut all = Self::ZERO;
        for item in &mut all {
            *item = T::decode(r)?;
        }
        Ok(all)
    }
}

/// Define a record: a plain structure whose fields all are [`Field`]s.
///
/// ```
/// rcs_core::record! {
///     /// Where the table of the pedestal stands.
///     pub struct Table {
///         /// Angle in tenths of a degree.
///         pub angle: i32,
///         /// True while it moves.
///         pub moving: bool,
///     }
/// }
/// use rcs_core::record::{Field, to_bytes};
/// assert_eq!(Table::SIZE, 5);
/// assert_eq!(to_bytes::<5, _>(&Table { angle: -2135, moving: true }), [0xA9, 0xF7, 0xFF, 0xFF, 1]);
/// ```
#[macro_export]
macro_rules! record {
    ($(#[$meta:meta])* $vis:vis struct $name:ident { $( $(#[$field_meta:meta])* $field_vis:vis $field:ident : $type:ty, )* }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[repr(C)]
        $vis struct $name { $( $(#[$field_meta])* $field_vis $field: $type, )* }

        impl Default for $name {
            fn default() -> Self {
                <Self as $crate::record::Field>::ZERO
            }
        }

        impl $name {
            /// The fields of the byte image.
            pub const RECORD: &'static $crate::record::RecordSchema = &$crate::record::RecordSchema {
                name: stringify!($name),
                fields: &[ $( $crate::record::FieldSchema {
                    name: stringify!($field),
                    schema: <$type as $crate::record::Field>::SCHEMA,
                }, )* ],
            };
        }

        impl $crate::record::Field for $name {
            const SCHEMA: $crate::record::Schema = $crate::record::Schema::Record(Self::RECORD);
            const ZERO: Self = Self { $( $field: <$type as $crate::record::Field>::ZERO, )* };

            fn encode(&self, w: &mut $crate::record::Writer<'_>) {
                $( $crate::record::Field::encode(&self.$field, w); )*
            }

            fn decode(r: &mut $crate::record::Reader<'_>) -> Result<Self, $crate::record::DecodeError> {
                Ok(Self { $( $field: $crate::record::Field::decode(r)?, )* })
            }
        }
    };
}

/// Define an enum that stands in records: each variant with its text, which is the manual's word where it has one.
/// Codes are the position of the variant from 0; the first variant is the value before anything was written.
#[macro_export]
macro_rules! coded_enum {
    ($(#[$meta:meta])* $vis:vis enum $name:ident { $( $(#[$variant_meta:meta])* $variant:ident = $text:literal, )+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(u8)]
        $vis enum $name { $( $(#[$variant_meta])* $variant, )+ }

        #[allow(dead_code, reason = "not every enum needs every conversion")]
        impl $name {
            /// All variants in the order of their codes.
            pub const ALL: &'static [Self] = &[ $( Self::$variant, )+ ];

            /// The text in logs and on screens.
            #[must_use]
            pub const fn text(self) -> &'static str {
                match self { $( Self::$variant => $text, )+ }
            }

            /// The code in a byte image.
            #[must_use]
            #[expect(clippy::as_conversions, reason = "the discriminant of a repr(u8) enum is its code")]
            pub const fn code(self) -> u8 {
                self as u8
            }

            /// The variant with a code.
            #[must_use]
            pub fn from_code(code: u8) -> Option<Self> {
                Self::ALL.get(usize::from(code)).copied()
            }

            /// The variant with a text.
            #[must_use]
            pub fn from_text(text: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|v| v.text() == text)
            }
        }

        impl Default for $name {
            fn default() -> Self {
                <Self as $crate::record::Field>::ZERO
            }
        }

        impl core::fmt::Display for $name {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.pad(self.text())
            }
        }

        impl $crate::record::Field for $name {
            const SCHEMA: $crate::record::Schema = $crate::record::Schema::Enum(&$crate::record::EnumSchema {
                name: stringify!($name),
                variants: &[ $( ($name::$variant.code(), $text), )+ ],
            });
            const ZERO: Self = $crate::first_variant!($name $($variant)+);

            fn encode(&self, w: &mut $crate::record::Writer<'_>) {
                $crate::record::Field::encode(&self.code(), w);
            }

            fn decode(r: &mut $crate::record::Reader<'_>) -> Result<Self, $crate::record::DecodeError> {
                let found = <u8 as $crate::record::Field>::decode(r)?;
                Self::from_code(found).ok_or($crate::record::DecodeError::BadCode { of: stringify!($name), found })
            }
        }
    };
}

/// The first variant of an enum; part of [`coded_enum!`](crate::coded_enum!).
#[doc(hidden)]
#[macro_export]
macro_rules! first_variant {
    ($name:ident $first:ident $($rest:ident)*) => {
        $name::$first
    };
}

/// The byte image of a record whose size is `N`.
pub fn to_bytes<const N: usize, T: Field>(record: &T) -> [u8; N] {
    let mut bytes = [0; N];
    record.encode(&mut Writer::new(&mut bytes));
    bytes
}

/// A record from its byte image.
///
/// # Errors
/// [`DecodeError`] if the bytes are not the image of a legal record.
pub fn from_bytes<T: Field>(bytes: &[u8]) -> Result<T, DecodeError> {
    T::decode(&mut Reader::new(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    coded_enum! {
        /// For the test.
        enum Light { Off = "off", On = "on", }
    }

    record! {
        /// For the test.
        struct Lamp {
            number: u16,
            light: Light,
            hours: [i32; 2],
        }
    }

    #[test]
    fn image_is_little_endian_without_padding() {
        let lamp = Lamp { number: 0x1234, light: Light::On, hours: [-1, 2] };
        let bytes: [u8; 11] = to_bytes(&lamp);
        assert_eq!(Lamp::SIZE, 11);
        assert_eq!(bytes, [0x34, 0x12, 1, 0xFF, 0xFF, 0xFF, 0xFF, 2, 0, 0, 0]);
        assert_eq!(from_bytes::<Lamp>(&bytes), Ok(lamp));
    }

    #[test]
    fn a_bad_code_is_refused() {
        let bytes = [0x34, 0x12, 7, 0, 0, 0, 0, 2, 0, 0, 0];
        assert_eq!(from_bytes::<Lamp>(&bytes), Err(DecodeError::BadCode { of: "Light", found: 7 }));
        assert_eq!(from_bytes::<Lamp>(bytes.get(..2).unwrap()), Err(DecodeError::TooShort));
    }

    #[test]
    fn a_writer_without_room_counts() {
        let mut bytes = [0xA5; 3];
        let mut w = Writer::new(&mut bytes);
        Lamp::default().encode(&mut w);
        assert!(w.missing() > 0);
    }
}
