//! Plain data: the fixed-size values that processes exchange and store.
//!
//! `#[derive(Plain)]` on a type generates its byte image (field by field, little-endian, without padding), the
//! checked conversion from bytes, and a [`Schema`] for recorders, viewers and the digest. Equal values have equal
//! bytes. External bytes become a value only if every name, flag and enum in them is valid.
//!
//! ```
//! use rcs_core::{Plain, plain::to_bytes};
//!
//! /// Where the table of the pedestal stands.
//! #[derive(Clone, Copy, Debug, PartialEq, Plain)]
//! pub struct Table {
//!     /// Angle, 0.1 degree.
//!     pub angle: i32,
//!     /// The object on it, if there is one.
//!     pub object: Option<u8>,
//! }
//! assert_eq!(Table::SIZE, 6);
//! assert_eq!(to_bytes::<6, _>(&Table { angle: -2135, object: Some(7) }), [0xA9, 0xF7, 0xFF, 0xFF, 1, 7]);
//! ```

use core::fmt;

/// The content of a byte image, as a tree of constants.
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
    /// A name of this many bytes, zero-filled.
    Text(usize),
    /// One byte; the code of a variant.
    Enum(&'static EnumSchema),
    /// This many elements of the same schema.
    Array(&'static Schema, usize),
    /// A struct.
    Struct(&'static StructSchema),
    /// One byte, 0 for none or 1, then the value, zero for none.
    Option(&'static Schema),
    /// One byte for the code of a variant, then its payload, then zeros up to the size of the largest variant.
    Union(&'static UnionSchema),
}

/// An enum without data.
#[derive(Debug, PartialEq)]
pub struct EnumSchema {
    /// Rust name of the enum.
    pub name: &'static str,
    /// The variants in the order of their codes.
    pub variants: &'static [VariantSchema],
}

/// A variant of an enum without data.
#[derive(Debug, PartialEq)]
pub struct VariantSchema {
    /// Code in the byte image.
    pub code: u8,
    /// Rust name.
    pub name: &'static str,
    /// Text in logs and on screens: the manual's word if there is one.
    pub text: &'static str,
    /// Meaning: the doc comment.
    pub doc: &'static str,
}

/// An enum with data.
#[derive(Debug, PartialEq)]
pub struct UnionSchema {
    /// Rust name of the enum.
    pub name: &'static str,
    /// The variants in the order of their codes.
    pub variants: &'static [UnionVariant],
    payload_size: usize,
}

/// A variant of an enum with data.
#[derive(Debug, PartialEq)]
pub struct UnionVariant {
    /// Code in the byte image.
    pub code: u8,
    /// Text in logs and on screens.
    pub text: &'static str,
    /// Name of the payload in paths and messages: the text as an identifier.
    pub name: &'static str,
    /// Schema of the payload.
    pub payload: Option<Schema>,
}

/// A struct: its name and fields in the order of the byte image.
#[derive(Debug, PartialEq)]
pub struct StructSchema {
    /// Rust name of the struct.
    pub name: &'static str,
    /// The fields.
    pub fields: &'static [FieldSchema],
    size: usize,
}

/// A field of a struct.
#[derive(Debug, PartialEq)]
pub struct FieldSchema {
    /// Rust name of the field.
    pub name: &'static str,
    /// Schema of the field.
    pub schema: Schema,
}

impl Schema {
    /// Bytes of the image.
    #[must_use]
    #[inline]
    pub const fn size(&self) -> usize {
        match self {
            Self::U8 | Self::Bool | Self::Enum(_) => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 => 4,
            Self::U64 | Self::F64 => 8,
            Self::Text(n) => *n,
            Self::Array(of, n) => of.size().saturating_mul(*n),
            Self::Struct(record) => record.size(),
            Self::Option(of) => of.size().saturating_add(1),
            Self::Union(of) => of.payload_size().saturating_add(1),
        }
    }
}

impl EnumSchema {
    /// The variant of a Rust name.
    #[must_use]
    #[inline]
    pub fn named(&self, name: &str) -> Option<&'static VariantSchema> {
        self.variants.iter().find(|variant| variant.name == name)
    }
}

impl UnionSchema {
    /// The schema of an enum with these variants.
    #[must_use]
    #[inline]
    pub const fn new(name: &'static str, variants: &'static [UnionVariant]) -> Self {
        let (mut rest, mut payload_size) = (variants, 0_usize);
        while let Some((variant, more)) = rest.split_first() {
            if let Some(payload) = &variant.payload
                && payload.size() > payload_size
            {
                payload_size = payload.size();
            }
            rest = more;
        }
        Self { name, variants, payload_size }
    }

    /// Size of the largest payload, bytes.
    #[must_use]
    #[inline]
    pub const fn payload_size(&self) -> usize {
        self.payload_size
    }
}

impl StructSchema {
    /// The schema of a struct with these fields.
    #[must_use]
    #[inline]
    pub const fn new(name: &'static str, fields: &'static [FieldSchema]) -> Self {
        let (mut rest, mut size) = (fields, 0_usize);
        while let Some((field, more)) = rest.split_first() {
            size = size.saturating_add(field.schema.size());
            rest = more;
        }
        Self { name, fields, size }
    }

    /// Bytes of the image.
    #[must_use]
    #[inline]
    pub const fn size(&self) -> usize {
        self.size
    }
}

/// Reason why bytes are not a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DecodeError {
    /// The record has more bytes.
    TooShort,
    /// A name with blanks, control characters or bytes after its end.
    BadName,
    /// A flag that is neither 0 nor 1.
    BadFlag(u8),
    /// An unused byte that is not 0.
    BadFill(u8),
    /// A code without a variant.
    BadCode {
        /// Name of the enum.
        of: &'static str,
        /// The code found.
        found: u8,
    },
}

impl fmt::Display for DecodeError {
    #[inline]
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooShort => f.write_str("the record has more bytes"),
            Self::BadName => f.write_str("a name contains invalid bytes"),
            Self::BadFlag(found) => write!(f, "a flag is 0 or 1, found {found}"),
            Self::BadFill(found) => write!(f, "an unused byte must be 0, found {found}"),
            Self::BadCode { of, found } => write!(f, "{of} has no variant with code {found}"),
        }
    }
}

impl core::error::Error for DecodeError {}

/// Writes fields into a byte image. Bytes that do not fit are counted and not written.
pub struct Writer<'a> {
    rest: &'a mut [u8],
    missing: usize,
}

impl<'a> Writer<'a> {
    /// A writer over `bytes`.
    #[inline]
    pub const fn new(bytes: &'a mut [u8]) -> Self {
        Self { rest: bytes, missing: 0 }
    }

    /// Append `bytes`.
    #[inline]
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

    /// The next `N` bytes to write. `None` if they do not fit; they are then counted.
    #[inline]
    pub fn chunk<const N: usize>(&mut self) -> Option<&'a mut [u8; N]> {
        match core::mem::take(&mut self.rest).split_first_chunk_mut::<N>() {
            Some((here, rest)) => {
                self.rest = rest;
                Some(here)
            }
            None => {
                self.missing = self.missing.saturating_add(N);
                None
            }
        }
    }

    /// Append this many zeros.
    #[inline]
    pub fn zeros(&mut self, count: usize) {
        let fitting = count.min(self.rest.len());
        let (here, rest) = core::mem::take(&mut self.rest).split_at_mut(fitting);
        here.fill(0);
        self.rest = rest;
        self.missing = self.missing.saturating_add(count.saturating_sub(fitting));
    }

    /// Bytes that did not fit.
    #[must_use]
    #[inline]
    pub const fn missing(&self) -> usize {
        self.missing
    }
}

/// Reads fields from a byte image.
pub struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    /// A reader over `bytes`.
    #[must_use]
    #[inline]
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// The next `N` bytes. Errors: [`DecodeError::TooShort`] if fewer remain.
    #[inline]
    pub fn take<const N: usize>(&mut self) -> Result<[u8; N], DecodeError> {
        self.chunk().copied()
    }

    /// The next `N` bytes in place. Errors: [`DecodeError::TooShort`] if fewer remain.
    #[inline]
    pub fn chunk<const N: usize>(&mut self) -> Result<&'a [u8; N], DecodeError> {
        let (here, rest) = self.rest.split_first_chunk::<N>().ok_or(DecodeError::TooShort)?;
        self.rest = rest;
        Ok(here)
    }

    /// Skips zeros. Errors: [`DecodeError::BadFill`] if a byte is not zero, [`DecodeError::TooShort`] if fewer remain.
    #[inline]
    pub fn zeros(&mut self, count: usize) -> Result<(), DecodeError> {
        let (here, rest) = self.rest.split_at(count.min(self.rest.len()));
        if let Some(found) = here.iter().find(|byte| **byte != 0) {
            return Err(DecodeError::BadFill(*found));
        }
        self.rest = rest;
        if here.len() < count { Err(DecodeError::TooShort) } else { Ok(()) }
    }
}

/// Plain data: a number, a name, an enum, or an array, option or struct of plain data.
pub trait Plain: Copy + PartialEq {
    /// Schema of its byte image.
    const SCHEMA: Schema;
    /// Bytes of the image.
    const SIZE: usize = Self::SCHEMA.size();
    /// The value of an unwritten buffer.
    const ZERO: Self;

    /// Append the image.
    fn encode(&self, w: &mut Writer<'_>);

    /// Read it from a byte image. Errors: [`DecodeError`] if the bytes are not the image of a valid value.
    fn decode(r: &mut Reader<'_>) -> Result<Self, DecodeError>;
}

macro_rules! number {
    ($($type:ty => $schema:ident, $zero:expr;)*) => {$(
        impl Plain for $type {
            const SCHEMA: Schema = Schema::$schema;
            const ZERO: Self = $zero;

            #[inline]
            fn encode(&self, w: &mut Writer<'_>) {
                w.put(&self.to_le_bytes());
            }

            #[inline]
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

impl Plain for bool {
    const SCHEMA: Schema = Schema::Bool;
    const ZERO: Self = false;

    #[inline]
    fn encode(&self, w: &mut Writer<'_>) {
        u8::from(*self).encode(w);
    }

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Result<Self, DecodeError> {
        match u8::decode(r)? {
            0 => Ok(false),
            1 => Ok(true),
            other => Err(DecodeError::BadFlag(other)),
        }
    }
}

impl<T: Plain + 'static, const N: usize> Plain for [T; N] {
    const SCHEMA: Schema = Schema::Array(&T::SCHEMA, N);
    const ZERO: Self = [T::ZERO; N];

    #[inline]
    fn encode(&self, w: &mut Writer<'_>) {
        for item in self {
            item.encode(w);
        }
    }

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Result<Self, DecodeError> {
        let mut all = Self::ZERO;
        for item in &mut all {
            *item = T::decode(r)?;
        }
        Ok(all)
    }
}

impl<T: Plain + 'static> Plain for Option<T> {
    const SCHEMA: Schema = Schema::Option(&T::SCHEMA);
    const ZERO: Self = None;

    #[inline]
    fn encode(&self, w: &mut Writer<'_>) {
        self.is_some().encode(w);
        match self {
            Some(value) => value.encode(w),
            None => w.zeros(T::SIZE),
        }
    }

    #[inline]
    fn decode(r: &mut Reader<'_>) -> Result<Self, DecodeError> {
        if bool::decode(r)? { T::decode(r).map(Some) } else { r.zeros(T::SIZE).map(|()| None) }
    }
}

/// The byte image of a record whose size is `N`.
#[inline]
pub fn to_bytes<const N: usize, T: Plain>(record: &T) -> [u8; N] {
    let mut bytes = [0; N];
    record.encode(&mut Writer::new(&mut bytes));
    bytes
}

/// A record from its byte image. Errors: [`DecodeError`] if the bytes are not the image of a valid record.
#[inline]
pub fn from_bytes<T: Plain>(bytes: &[u8]) -> Result<T, DecodeError> {
    T::decode(&mut Reader::new(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rcs_macros::Plain;

    #[derive(Clone, Copy, Debug, PartialEq, Plain)]
    enum Light {
        Off,
        On,
    }

    #[derive(Clone, Copy, Debug, PartialEq, Plain)]
    struct Lamp {
        number: u16,
        light: Light,
        hours: [i32; 2],
    }

    #[derive(Clone, Copy, Debug, PartialEq, Plain)]
    enum Fixture {
        Nothing,
        #[text = "a lamp"]
        Lamp(Lamp),
        Candle(u8),
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
    fn unused_bytes_of_options_and_variants_are_zero() {
        assert_eq!(to_bytes::<3, _>(&Some(0x1234_u16)), [1, 0x34, 0x12]);
        assert_eq!(to_bytes::<3, _>(&None::<u16>), [0, 0, 0]);
        assert_eq!(from_bytes::<Option<u16>>(&[0, 0, 9]), Err(DecodeError::BadFill(9)));
        assert_eq!(from_bytes::<Option<u16>>(&[0, 0]), Err(DecodeError::TooShort));
        assert_eq!(from_bytes::<Option<u16>>(&[0, 7]), Err(DecodeError::BadFill(7)));
        assert_eq!(from_bytes::<Option<u16>>(&[2, 0, 0]), Err(DecodeError::BadFlag(2)));
        assert_eq!(Fixture::SIZE, 12);
        let image: [u8; 12] = to_bytes(&Fixture::Candle(7));
        assert_eq!(image, [2, 7, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(from_bytes(&image), Ok(Fixture::Candle(7)));
        assert_eq!(from_bytes::<Fixture>(&[3; 12]), Err(DecodeError::BadCode { of: "Fixture", found: 3 }));
        assert_eq!(from_bytes::<Fixture>(&[2; 12]), Err(DecodeError::BadFill(2)));
        let lamp = Fixture::Lamp(Lamp { number: 1, light: Light::On, hours: [2, 3] });
        assert_eq!(from_bytes(&to_bytes::<12, _>(&lamp)), Ok(lamp));
    }

    #[test]
    fn a_variant_has_a_text_and_a_meaning() {
        assert_eq!(Light::from_text("on"), Some(Light::On));
        assert_eq!(Light::ENUM.named("Off").map(|off| (off.code, off.text)), Some((0, "off")));
        assert_eq!(
            Fixture::UNION.variants.iter().map(|v| v.text).collect::<Vec<_>>(),
            ["nothing", "a lamp", "candle"]
        );
    }

    #[test]
    fn full_writer_counts_missing_bytes() {
        let mut bytes = [0xA5; 3];
        let mut w = Writer::new(&mut bytes);
        Lamp::default().encode(&mut w);
        assert!(w.missing() > 0);
    }
}
