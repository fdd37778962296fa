//! Codes of the values in mailbox data: integers low byte first, texts padded with blanks.

use std::fmt::{self, Write as _};

use rcs_core::{
    Plain,
    name::{Name, Name16},
    plain::{EnumSchema, Schema, from_bytes, to_bytes},
    tick::Tick,
};

use super::{At, Codec, Width};
use crate::fields::{FieldError, command_number};

const BLANK: u8 = b' ';

macro_rules! codes {
    ($( $(#[$meta:meta])* $name:ident $(<$width:ident>)? = $bytes:expr; )+) => {$(
        $(#[$meta])*
        #[derive(Clone, Copy, Debug)]
        pub struct $name $(<const $width: usize>)?;

        impl $(<const $width: usize>)? Width for $name $(<$width>)? {
            const BYTES: usize = $bytes;
        }
    )+};
}

codes! {
    /// An unused field, written as blanks.
    Unused<W> = W;
    /// An unsigned integer of two bytes.
    U16 = 2;
    /// A signed integer of two bytes.
    I16 = 2;
    /// An unsigned integer of four bytes.
    U32 = 4;
    /// A signed integer of four bytes.
    I32 = 4;
    /// An unsigned integer of eight bytes, or the bits of a floating-point number.
    U64 = 8;
    /// 1 or 0, in two bytes.
    Flag = 2;
    /// The number of a command: four bytes in the controller, two in the mailbox ([`command_number`]).
    Number = 2;
    /// A name of `W` characters, padded with blanks or zeros.
    Chars<W> = W;
    /// A text of `W` printable characters. A longer text is truncated.
    Text<W> = W;
    /// A value by its word, in `W` characters.
    Spelled<W> = W;
    /// A value by its code, in `W` bytes.
    Coded<W> = W;
}

#[derive(Clone, Copy, Debug)]
pub struct Given<C>(std::marker::PhantomData<C>); // Blank or 0 means `None`

impl<C: Width> Width for Given<C> {
    const BYTES: usize = C::BYTES;
}

impl<'a, C: Codec<'a, T>, T: Copy + Default + PartialEq> Codec<'a, Option<T>> for Given<C> {
    fn misfit(value: &Option<T>) -> Option<i32> {
        C::misfit(&value.unwrap_or_default())
    }

    fn put(value: &Option<T>, to: &mut [u8]) {
        C::put(&value.unwrap_or_default(), to);
    }

    fn take(at: At, from: &'a [u8]) -> Result<Option<T>, FieldError> {
        C::take(at, from).map(|found| Some(found).filter(|found| *found != T::default()))
    }
}

impl<const W: usize> Codec<'_, ()> for Unused<W> {
    fn put((): &(), to: &mut [u8]) {
        to.fill(BLANK);
    }

    fn take(_: At, _: &[u8]) -> Result<(), FieldError> {
        Ok(())
    }
}

fn chunk<const N: usize>(at: At, from: &[u8]) -> Result<[u8; N], FieldError> {
    from.try_into().map_err(|_| FieldError::End { field: at.field })
}

macro_rules! integers {
    ($( $code:ident: $type:ty; )+) => {$(
        impl Codec<'_, $type> for $code {
            fn put(value: &$type, to: &mut [u8]) {
                to.copy_from_slice(&value.to_le_bytes());
            }

            fn take(at: At, from: &[u8]) -> Result<$type, FieldError> {
                chunk(at, from).map(<$type>::from_le_bytes)
            }
        }
    )+};
}

integers! {
    U16: u16;
    I16: i16;
    U32: u32;
    I32: i32;
    U64: u64;
    U64: f64;
}

impl Codec<'_, Tick> for U64 {
    fn put(value: &Tick, to: &mut [u8]) {
        Self::put(&value.0, to);
    }

    fn take(at: At, from: &[u8]) -> Result<Tick, FieldError> {
        Self::take(at, from).map(Tick)
    }
}

impl Codec<'_, u8> for U16 {
    fn put(value: &u8, to: &mut [u8]) {
        Self::put(&u16::from(*value), to);
    }

    fn take(at: At, from: &[u8]) -> Result<u8, FieldError> {
        let found: u16 = Self::take(at, from)?;
        u8::try_from(found).map_err(|_| FieldError::Code { field: at.field, found })
    }
}

impl Codec<'_, i32> for I16 {
    fn misfit(value: &i32) -> Option<i32> {
        i16::try_from(*value).is_err().then_some(*value)
    }

    fn put(value: &i32, to: &mut [u8]) {
        let nearest = (*value).clamp(i16::MIN.into(), i16::MAX.into());
        Self::put(&i16::try_from(nearest).unwrap_or_default(), to);
    }

    fn take(at: At, from: &[u8]) -> Result<i32, FieldError> {
        chunk(at, from).map(|bytes| i16::from_le_bytes(bytes).into())
    }
}

impl Codec<'_, bool> for Flag {
    fn put(value: &bool, to: &mut [u8]) {
        U16::put(&u16::from(*value), to);
    }

    fn take(at: At, from: &[u8]) -> Result<bool, FieldError> {
        match U16::take(at, from)? {
            0 => Ok(false),
            1 => Ok(true),
            found => Err(FieldError::Code { field: at.field, found }),
        }
    }
}

impl Codec<'_, u32> for Number {
    fn put(value: &u32, to: &mut [u8]) {
        U16::put(&command_number(*value), to);
    }

    fn take(at: At, from: &[u8]) -> Result<u32, FieldError> {
        let found: u16 = U16::take(at, from)?;
        Ok(found.into())
    }
}

/// The characters without padding of blanks and zeros, if all are `legal`.
fn characters(at: At, from: &[u8], legal: impl Fn(u8) -> bool) -> Result<&str, FieldError> {
    let length = from.iter().rposition(|&byte| byte != BLANK && byte != 0).map_or(0, |last| last + 1);
    match from[..length].iter().position(|&byte| !legal(byte)) {
        Some(bad) => Err(FieldError::Character { field: at.field, at: at.byte + bad, found: from[bad] }),
        None => Ok(str::from_utf8(&from[..length]).unwrap_or_default()),
    }
}

fn put_text(text: &dyn fmt::Display, to: &mut [u8]) {
    to.fill(BLANK);
    // An error only means that the text was truncated, as intended.
    let _ = write!(Clipped { rest: to }, "{text}");
}

impl<const W: usize> Codec<'_, Name<W>> for Chars<W> {
    fn put(value: &Name<W>, to: &mut [u8]) {
        put_text(value, to);
    }

    fn take(at: At, from: &[u8]) -> Result<Name<W>, FieldError> {
        characters(at, from, |byte| byte.is_ascii_graphic()).map(Name::clipped)
    }
}

impl<'a, const W: usize> Codec<'a, &'a str> for Text<W> {
    fn put(value: &&'a str, to: &mut [u8]) {
        put_text(value, to);
    }

    fn take(at: At, from: &'a [u8]) -> Result<&'a str, FieldError> {
        characters(at, from, |byte| byte == BLANK || byte.is_ascii_graphic())
    }
}

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

fn variants<T: Plain>() -> &'static EnumSchema {
    match T::SCHEMA {
        Schema::Enum(variants) => variants,
        _ => panic!("only an enum has words and codes"),
    }
}

fn code<T: Plain>(value: &T) -> u8 {
    let [code] = to_bytes(value);
    code
}

impl<const W: usize, T: Plain> Codec<'_, T> for Spelled<W> {
    fn put(value: &T, to: &mut [u8]) {
        let own = variants::<T>().variants.iter().find(|variant| variant.code == code(value));
        put_text(&own.map_or("", |variant| variant.text), to);
    }

    fn take(at: At, from: &[u8]) -> Result<T, FieldError> {
        let found: Name<W> = Chars::<W>::take(at, from)?;
        let known = variants::<T>().variants.iter().find(|variant| variant.text == found.as_str());
        known
            .and_then(|variant| from_bytes(&[variant.code]).ok())
            .ok_or_else(|| FieldError::Word { field: at.field, found: Name16::clipped(found.as_str()) })
    }
}

impl<const W: usize, T: Plain> Codec<'_, T> for Coded<W> {
    fn put(value: &T, to: &mut [u8]) {
        to.fill(0);
        to[0] = code(value);
    }

    fn take(at: At, from: &[u8]) -> Result<T, FieldError> {
        let found = || u16::from_le_bytes([from[0], from[1]]);
        let known = from[1..].iter().all(|byte| *byte == 0).then(|| from_bytes(&from[..1]).ok());
        known.flatten().ok_or_else(|| FieldError::Code { field: at.field, found: found() })
    }
}

/// Truncated to the length of a field. Formatting does not allocate.
#[derive(Clone, Copy, Debug)]
pub struct Sentence<const W: usize>([u8; W]);

impl<const W: usize> Sentence<W> {
    #[must_use]
    pub fn of(shown: &dyn fmt::Display) -> Self {
        let mut bytes = [BLANK; W];
        put_text(shown, &mut bytes);
        Self(bytes)
    }

    #[must_use]
    pub fn as_str(&self) -> &str {
        str::from_utf8(&self.0).unwrap_or_default().trim_end_matches(' ')
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT: At = At { field: "obj", byte: 40 };

    #[test]
    fn name_padding_may_be_zeros_and_invalid_bytes_are_named() {
        let name = |bytes: &'static [u8; 4]| -> Result<Name<4>, FieldError> { Chars::<4>::take(AT, bytes) };
        assert_eq!(name(b"AB\0 ").unwrap().as_str(), "AB");
        assert!(name(b"\0\0\0\0").unwrap().is_empty());
        assert_eq!(name(b"A B "), Err(FieldError::Character { field: "obj", at: 41, found: b' ' }));
        let error = name(b"AB\x07C").unwrap_err();
        assert!(error.to_string().ends_with("for obj, found 07 at byte 42"), "{error}");
        let text: Result<&str, _> = Text::<6>::take(AT, b"A B\0 \0");
        assert_eq!(text, Ok("A B"));
    }

    #[test]
    fn integers_out_of_range_are_detected_and_clamped() {
        let mut bytes = [0xA5; 2];
        let misfit = <I16 as Codec<'_, i32>>::misfit;
        assert_eq!((misfit(&-40_000), misfit(&-32_768)), (Some(-40_000), None));
        I16::put(&-40_000_i32, &mut bytes);
        assert_eq!(bytes, i16::MIN.to_le_bytes());
    }

    #[test]
    fn flags_and_codes_are_legal_or_named() {
        let flag: Result<bool, _> = Flag::take(AT, &[0, 1]);
        assert_eq!(flag, Err(FieldError::Code { field: "obj", found: 256 }));
        let byte: Result<u8, _> = U16::take(AT, &[0, 1]);
        assert_eq!(byte, Err(FieldError::Code { field: "obj", found: 256 }));
        let reason: Result<interfaces::Reason, _> = Coded::<4>::take(AT, &[1, 0, 1, 0]);
        assert_eq!(reason, Err(FieldError::Code { field: "obj", found: 1 }));
    }

    #[test]
    fn sentence_is_truncated_to_its_field() {
        assert_eq!(Sentence::<6>::of(&"too long for it").as_str(), "too lo");
        assert_eq!(Sentence::<20>::of(&"é!").as_str(), "??!");
    }
}
