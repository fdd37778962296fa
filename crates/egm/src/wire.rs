//! The part of protocol-buffer encoding that `egm.proto` needs: a reader and a writer over byte slices.
//!
//! The writer works backwards from the end of its buffer: a nested message is then written before its length, which
//! precedes it. Each message writes its fields in reverse order.

use crate::Error;

/// Wire type of variable-length integers.
pub const VARINT: u8 = 0;
/// Wire type of eight bytes, little-endian: doubles.
pub const FIXED64: u8 = 1;
/// Wire type of a length followed by that number of bytes.
pub const BYTES: u8 = 2;
/// Wire type of four bytes.
pub const FIXED32: u8 = 5;
const MOST_FIELDS: u64 = (1 << 29) - 1;

/// A value on the wire.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value<'a> {
    /// An integer, a flag or an enum.
    Varint(u64),
    /// Eight bytes.
    Fixed64(u64),
    /// A message, or packed values.
    Bytes(&'a [u8]),
    /// Four bytes; `egm.proto` has no such field.
    Fixed32(u32),
}

/// A field: its number and its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field<'a> {
    /// Number in the schema.
    pub number: u32,
    /// Value of the field.
    pub value: Value<'a>,
}

impl<'a> Field<'a> {
    fn wrong(&self) -> Error {
        let found = match self.value {
            Value::Varint(_) => VARINT,
            Value::Fixed64(_) => FIXED64,
            Value::Bytes(_) => BYTES,
            Value::Fixed32(_) => FIXED32,
        };
        Error::BadWireType { field: self.number, found }
    }

    /// The value as a 64-bit integer. Errors: [`Error::BadWireType`] for another wire type.
    pub fn uint64(&self) -> Result<u64, Error> {
        if let Value::Varint(value) = self.value { Ok(value) } else { Err(self.wrong()) }
    }

    /// The low 32 bits, as for `uint32` and enums. Errors: [`Error::BadWireType`] for another wire type.
    pub fn uint32(&self) -> Result<u32, Error> {
        let [a, b, c, d, ..] = self.uint64()?.to_le_bytes();
        Ok(u32::from_le_bytes([a, b, c, d]))
    }

    /// The value as a boolean. Errors: [`Error::BadWireType`] for another wire type.
    pub fn flag(&self) -> Result<bool, Error> {
        Ok(self.uint64()? != 0)
    }

    /// The value as a double. Errors: [`Error::BadWireType`] for another wire type.
    pub fn double(&self) -> Result<f64, Error> {
        if let Value::Fixed64(bits) = self.value { Ok(f64::from_bits(bits)) } else { Err(self.wrong()) }
    }

    /// The fields of the message in the value. Errors: [`Error::BadWireType`] for another wire type.
    pub fn message(&self) -> Result<Reader<'a>, Error> {
        if let Value::Bytes(bytes) = self.value { Ok(Reader::new(bytes)) } else { Err(self.wrong()) }
    }
}

/// Reads the fields of a message in order.
#[derive(Clone, Debug)]
pub struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    /// A reader of the fields in `bytes`.
    #[must_use]
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// Returns true at the end of the bytes.
    #[must_use]
    pub const fn is_at_end(&self) -> bool {
        self.rest.is_empty()
    }

    /// Reads the next field; `None` at the end. Errors: [`Error`] if the bytes are not a field.
    pub fn next_field(&mut self) -> Result<Option<Field<'a>>, Error> {
        if self.is_at_end() {
            return Ok(None);
        }
        let key = self.varint()?;
        let number = key >> 3;
        if !(1..=MOST_FIELDS).contains(&number) {
            return Err(Error::BadField { number });
        }
        let number = u32::try_from(number).map_err(|_| Error::BadField { number })?;
        let wire_type = u8::try_from(key & 7).unwrap_or(u8::MAX);
        let value = match wire_type {
            VARINT => Value::Varint(self.varint()?),
            FIXED64 => Value::Fixed64(self.fixed64()?),
            BYTES => {
                let length = usize::try_from(self.varint()?).map_err(|_| Error::Truncated)?;
                Value::Bytes(self.take(length)?)
            }
            FIXED32 => Value::Fixed32(u32::from_le_bytes(self.array()?)),
            found => return Err(Error::BadWireType { field: number, found }),
        };
        Ok(Some(Field { number, value }))
    }

    /// Reads the next double of packed values; `None` at the end. Errors: [`Error::Truncated`].
    pub fn next_double(&mut self) -> Result<Option<f64>, Error> {
        if self.is_at_end() { Ok(None) } else { self.fixed64().map(|bits| Some(f64::from_bits(bits))) }
    }

    fn take(&mut self, length: usize) -> Result<&'a [u8], Error> {
        let (taken, rest) = self.rest.split_at_checked(length).ok_or(Error::Truncated)?;
        self.rest = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Error> {
        let (taken, rest) = self.rest.split_first_chunk().ok_or(Error::Truncated)?;
        self.rest = rest;
        Ok(*taken)
    }

    fn fixed64(&mut self) -> Result<u64, Error> {
        self.array().map(u64::from_le_bytes)
    }

    fn varint(&mut self) -> Result<u64, Error> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let [byte] = self.array()?;
            let bits = u64::from(byte & 0x7F);
            // The tenth byte holds only the last bit.
            if shift == 63 && byte > 1 {
                return Err(Error::LongVarint);
            }
            value |= bits << shift;
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err(Error::LongVarint)
    }
}

/// Writes a message from the end of a buffer to the front.
#[derive(Debug)]
pub struct Writer<'a> {
    buffer: &'a mut [u8],
    start: usize, // offset of the first written byte
}

impl<'a> Writer<'a> {
    /// A writer that has written nothing.
    #[must_use]
    pub const fn new(buffer: &'a mut [u8]) -> Self {
        let start = buffer.len();
        Self { buffer, start }
    }

    /// The written bytes.
    #[must_use]
    pub fn finish(self) -> &'a [u8] {
        self.buffer.get(self.start..).unwrap_or_default()
    }

    /// Writes an integer field. Errors: [`Error::NoRoom`] if the buffer is too small.
    pub fn uint(&mut self, number: u32, value: u64) -> Result<(), Error> {
        self.varint(value)?;
        self.key(number, VARINT)
    }

    /// Writes a boolean field. Errors: [`Error::NoRoom`] if the buffer is too small.
    pub fn flag(&mut self, number: u32, value: bool) -> Result<(), Error> {
        self.uint(number, u64::from(value))
    }

    /// Writes a double field. Errors: [`Error::NoRoom`] if the buffer is too small.
    pub fn double(&mut self, number: u32, value: f64) -> Result<(), Error> {
        self.bytes(&value.to_le_bytes())?;
        self.key(number, FIXED64)
    }

    /// Writes a message field; `fields` writes its fields in reverse order. Errors: [`Error::NoRoom`].
    pub fn message(
        &mut self,
        number: u32,
        fields: impl FnOnce(&mut Self) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let end = self.start;
        fields(self)?;
        let length = end.saturating_sub(self.start);
        self.varint(u64::try_from(length).map_err(|_| Error::NoRoom)?)?;
        self.key(number, BYTES)
    }

    fn key(&mut self, number: u32, wire_type: u8) -> Result<(), Error> {
        self.varint(u64::from(number) << 3 | u64::from(wire_type))
    }

    fn varint(&mut self, value: u64) -> Result<(), Error> {
        let mut bytes = [0; 10];
        let mut length = 0_usize;
        let mut rest = value;
        for slot in &mut bytes {
            let low = u8::try_from(rest & 0x7F).unwrap_or_default();
            rest >>= 7;
            *slot = if rest == 0 { low } else { low | 0x80 };
            length = length.saturating_add(1);
            if rest == 0 {
                break;
            }
        }
        self.bytes(bytes.get(..length).unwrap_or_default())
    }

    fn bytes(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let start = self.start.checked_sub(bytes.len()).ok_or(Error::NoRoom)?;
        self.buffer.get_mut(start..self.start).ok_or(Error::NoRoom)?.copy_from_slice(bytes);
        self.start = start;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_are_written_as_they_are_read() {
        for value in [0, 1, 127, 128, 300, u64::from(u32::MAX), u64::MAX] {
            let mut buffer = [0xA5; 16];
            let mut writer = Writer::new(&mut buffer);
            writer.uint(3, value).unwrap();
            let mut reader = Reader::new(writer.finish());
            assert_eq!(reader.next_field(), Ok(Some(Field { number: 3, value: Value::Varint(value) })));
            assert_eq!(reader.next_field(), Ok(None));
        }
    }

    #[test]
    fn the_bytes_are_those_of_the_encoding_s_description() {
        let mut buffer = [0xA5; 16];
        let mut writer = Writer::new(&mut buffer);
        writer.message(3, |inner| inner.uint(1, 150)).unwrap();
        assert_eq!(writer.finish(), [0x1A, 0x03, 0x08, 0x96, 0x01]);
        let mut writer = Writer::new(&mut buffer);
        writer.double(2, 1.0).unwrap();
        assert_eq!(writer.finish(), [0x11, 0, 0, 0, 0, 0, 0, 0xF0, 0x3F]);
    }

    #[test]
    fn unknown_fields_are_refused_by_name() {
        let first = |bytes: &[u8]| Reader::new(bytes).next_field().map(|_| ());
        assert_eq!(first(&[0x08]), Err(Error::Truncated));
        assert_eq!(first(&[0x09, 1, 2, 3]), Err(Error::Truncated));
        assert_eq!(first(&[0x0A, 5, 1]), Err(Error::Truncated));
        assert_eq!(first(&[0x08; 1]), Err(Error::Truncated));
        assert_eq!(first(&[0x00, 1]), Err(Error::BadField { number: 0 }));
        assert_eq!(first(&[0x0B]), Err(Error::BadWireType { field: 1, found: 3 }));
        assert_eq!(first(&[0x08, 255, 255, 255, 255, 255, 255, 255, 255, 255, 2]), Err(Error::LongVarint));
        let mut small = [0; 4];
        assert_eq!(Writer::new(&mut small).double(1, 1.0), Err(Error::NoRoom));
    }
}
