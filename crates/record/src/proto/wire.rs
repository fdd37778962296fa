//! The part of the protobuf wire format that a log uses.
//!
//! Zero values are written, too, because some readers would otherwise interrupt a curve at zero.

const VARINT: u64 = 0;
const FIXED64: u64 = 1; // wire type of eight bytes
const BYTES: u64 = 2; // wire type of a length and the bytes after it
const FIXED32: u64 = 5; // wire type of four bytes

/// Append a number in groups of seven bits, the lowest first.
pub fn put_varint(mut value: u64, out: &mut Vec<u8>) {
    while value >= 0x80 {
        out.push((value & 0x7F) as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

/// Take a number from the front of `bytes`; `None` if it is incomplete or does not fit in 64 bits.
pub fn take_varint(bytes: &mut &[u8]) -> Option<u64> {
    if let [byte @ 0..=0x7F, rest @ ..] = *bytes {
        *bytes = rest;
        return Some(u64::from(*byte));
    }
    let mut value = 0_u64;
    for group in 0..10_u32 {
        let (byte, rest) = bytes.split_first()?;
        *bytes = rest;
        let bits = u64::from(byte & 0x7F);
        if group == 9 && bits > 1 {
            return None;
        }
        value |= bits << (7 * group);
        if byte & 0x80 == 0 {
            return Some(value);
        }
    }
    None
}

/// Map signed numbers of small magnitude to small unsigned ones.
#[must_use]
pub const fn zigzag(value: i64) -> u64 {
    ((value << 1) ^ (value >> 63)).cast_unsigned()
}

#[must_use]
pub const fn unzigzag(value: u64) -> i64 {
    (value >> 1).cast_signed() ^ -((value & 1).cast_signed())
}

fn tag(field: u32, wire_type: u64, out: &mut Vec<u8>) {
    put_varint(u64::from(field) << 3 | wire_type, out);
}

/// A `uint32`, `uint64`, `bool`, enum, or non-negative `int32` field.
pub fn unsigned(field: u32, value: u64, out: &mut Vec<u8>) {
    tag(field, VARINT, out);
    put_varint(value, out);
}

pub fn signed(field: u32, value: i64, out: &mut Vec<u8>) {
    unsigned(field, zigzag(value), out);
}

pub fn double(field: u32, value: f64, out: &mut Vec<u8>) {
    tag(field, FIXED64, out);
    out.extend_from_slice(&value.to_le_bytes());
}

pub fn fixed64(field: u32, value: u64, out: &mut Vec<u8>) {
    tag(field, FIXED64, out);
    out.extend_from_slice(&value.to_le_bytes());
}

pub fn fixed32(field: u32, value: u32, out: &mut Vec<u8>) {
    tag(field, FIXED32, out);
    out.extend_from_slice(&value.to_le_bytes());
}

/// A `bytes` or `string` field.
pub fn bytes(field: u32, value: &[u8], out: &mut Vec<u8>) {
    tag(field, BYTES, out);
    put_varint(value.len() as u64, out);
    out.extend_from_slice(value);
}

/// A message or a packed array: the bytes that `body` appends, preceded by their length.
pub fn nested(field: u32, out: &mut Vec<u8>, body: impl FnOnce(&mut Vec<u8>)) {
    tag(field, BYTES, out);
    let start = out.len();
    body(out);
    let length = out.len() - start;
    put_varint(length as u64, out);
    let prefix = out.len() - start - length;
    if let Some(tail) = out.get_mut(start..) {
        tail.rotate_right(prefix);
    }
}

/// Fields of a message, in the order of the wire, up to the first malformed one.
pub struct Fields<'a>(pub &'a [u8]);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Value<'a> {
    Number(u64),
    Bytes(&'a [u8]),
}

impl<'a> Iterator for Fields<'a> {
    type Item = (u64, Value<'a>);

    fn next(&mut self) -> Option<Self::Item> {
        let key = take_varint(&mut self.0)?;
        let length = match key & 7 {
            VARINT => return Some((key >> 3, Value::Number(take_varint(&mut self.0)?))),
            FIXED64 => 8,
            BYTES => usize::try_from(take_varint(&mut self.0)?).ok()?,
            FIXED32 => 4,
            _ => return None,
        };
        let (value, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        Some((key >> 3, Value::Bytes(value)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn varints_equal_those_of_the_protobuf_documentation() {
        let mut out = Vec::new();
        unsigned(1, 150, &mut out);
        assert_eq!(out, [0x08, 0x96, 0x01]);
        out.clear();
        bytes(2, b"testing", &mut out);
        assert_eq!(out, b"\x12\x07testing");
        assert_eq!([0, -1, 1, -2].map(zigzag), [0, 1, 2, 3]);
        assert_eq!(zigzag(i64::from(i32::MIN)), u64::from(u32::MAX));
        assert!([0, 1, -1, 77, i64::MIN, i64::MAX].iter().all(|value| unzigzag(zigzag(*value)) == *value));
    }

    #[test]
    fn nested_lengths_of_more_than_one_byte() {
        let mut out = vec![0xEE];
        nested(3, &mut out, |out| out.extend(std::iter::repeat_n(7, 200)));
        assert_eq!(out[..4], [0xEE, 0x1A, 0xC8, 0x01]);
        assert_eq!(out.len(), 204);
        assert_eq!(Fields(&out[1..]).next(), Some((3, Value::Bytes(&[7; 200]))));
    }

    #[test]
    fn varints_round_trip() {
        for value in [0, 1, 127, 128, 300, u64::from(u32::MAX), u64::MAX] {
            let mut out = Vec::new();
            put_varint(value, &mut out);
            let mut rest = out.as_slice();
            assert_eq!(take_varint(&mut rest), Some(value));
            assert!(rest.is_empty());
        }
        assert_eq!(take_varint(&mut [0xFF; 12].as_slice()), None);
    }
}
