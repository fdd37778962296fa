//! The bytes of a value for a digest: all its variable data, without its description.
//!
//! A digest is taken every tick, so it must be cheap: fields with the name `description`, which never change, are
//! omitted. Numbers are little-endian; sequences and texts are preceded by their length, enums by their variant.

use core::fmt;

use serde::{Serialize, Serializer, ser};

const CONSTANT: &str = "description"; // name of the fields that never change

/// Append the bytes of a value. Fails with [`fmt::Error`] if the value cannot be serialised.
pub fn append<T: Serialize + ?Sized>(value: &T, bytes: &mut Vec<u8>) -> fmt::Result {
    value.serialize(Writer(bytes))
}

struct Writer<'a>(&'a mut Vec<u8>);

impl Writer<'_> {
    fn put(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    fn length(&mut self, length: usize) {
        self.put(&(length as u64).to_le_bytes());
    }
}

macro_rules! numbers {
    ($($method:ident $type:ty;)*) => {$(
        fn $method(mut self, value: $type) -> fmt::Result {
            self.put(&value.to_le_bytes());
            Ok(())
        }
    )*};
}

impl Serializer for Writer<'_> {
    type Ok = ();
    type Error = fmt::Error;
    type SerializeSeq = Self;
    type SerializeTuple = Self;
    type SerializeTupleStruct = Self;
    type SerializeTupleVariant = Self;
    type SerializeMap = Self;
    type SerializeStruct = Self;
    type SerializeStructVariant = Self;

    numbers! {
        serialize_i8 i8; serialize_i16 i16; serialize_i32 i32; serialize_i64 i64; serialize_i128 i128;
        serialize_u8 u8; serialize_u16 u16; serialize_u32 u32; serialize_u64 u64; serialize_u128 u128;
        serialize_f32 f32; serialize_f64 f64;
    }

    fn serialize_bool(self, value: bool) -> fmt::Result {
        self.serialize_u8(value.into())
    }

    fn serialize_char(self, value: char) -> fmt::Result {
        self.serialize_u32(value.into())
    }

    fn serialize_str(self, value: &str) -> fmt::Result {
        self.serialize_bytes(value.as_bytes())
    }

    fn serialize_bytes(mut self, value: &[u8]) -> fmt::Result {
        self.length(value.len());
        self.put(value);
        Ok(())
    }

    fn serialize_none(self) -> fmt::Result {
        self.serialize_bool(false)
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> fmt::Result {
        self.0.push(1);
        value.serialize(self)
    }

    fn serialize_unit(self) -> fmt::Result {
        Ok(())
    }

    fn serialize_unit_struct(self, _name: &'static str) -> fmt::Result {
        Ok(())
    }

    fn serialize_unit_variant(self, _name: &'static str, index: u32, _variant: &'static str) -> fmt::Result {
        self.serialize_u32(index)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _name: &'static str, value: &T) -> fmt::Result {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        mut self,
        _name: &'static str,
        index: u32,
        _variant: &'static str,
        value: &T,
    ) -> fmt::Result {
        self.put(&index.to_le_bytes());
        value.serialize(self)
    }

    fn serialize_seq(mut self, length: Option<usize>) -> Result<Self, fmt::Error> {
        self.length(length.unwrap_or_default());
        Ok(self)
    }

    fn serialize_tuple(self, _length: usize) -> Result<Self, fmt::Error> {
        Ok(self)
    }

    fn serialize_tuple_struct(self, _name: &'static str, _length: usize) -> Result<Self, fmt::Error> {
        Ok(self)
    }

    fn serialize_tuple_variant(
        mut self,
        _name: &'static str,
        index: u32,
        _variant: &'static str,
        _length: usize,
    ) -> Result<Self, fmt::Error> {
        self.put(&index.to_le_bytes());
        Ok(self)
    }

    fn serialize_map(self, length: Option<usize>) -> Result<Self, fmt::Error> {
        self.serialize_seq(length)
    }

    fn serialize_struct(self, _name: &'static str, _length: usize) -> Result<Self, fmt::Error> {
        Ok(self)
    }

    fn serialize_struct_variant(
        self,
        name: &'static str,
        index: u32,
        variant: &'static str,
        length: usize,
    ) -> Result<Self, fmt::Error> {
        self.serialize_tuple_variant(name, index, variant, length)
    }

    fn is_human_readable(&self) -> bool {
        false
    }
}

macro_rules! elements {
    ($($trait:ident $method:ident;)*) => {$(
        impl ser::$trait for Writer<'_> {
            type Ok = ();
            type Error = fmt::Error;

            fn $method<T: Serialize + ?Sized>(&mut self, value: &T) -> fmt::Result {
                append(value, self.0)
            }

            fn end(self) -> fmt::Result {
                Ok(())
            }
        }
    )*};
}

elements! {
    SerializeSeq serialize_element;
    SerializeTuple serialize_element;
    SerializeTupleStruct serialize_field;
    SerializeTupleVariant serialize_field;
}

impl ser::SerializeMap for Writer<'_> {
    type Ok = ();
    type Error = fmt::Error;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> fmt::Result {
        append(key, self.0)
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> fmt::Result {
        append(value, self.0)
    }

    fn end(self) -> fmt::Result {
        Ok(())
    }
}

macro_rules! fields {
    ($($trait:ident)*) => {$(
        impl ser::$trait for Writer<'_> {
            type Ok = ();
            type Error = fmt::Error;

            fn serialize_field<T: Serialize + ?Sized>(&mut self, name: &'static str, value: &T) -> fmt::Result {
                if name == CONSTANT { Ok(()) } else { append(value, self.0) }
            }

            fn end(self) -> fmt::Result {
                Ok(())
            }
        }
    )*};
}

fields! { SerializeStruct SerializeStructVariant }

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[derive(Serialize)]
    enum Place {
        Nowhere,
        At(u8),
        Between { from: i16, to: i16 },
    }

    #[derive(Serialize)]
    struct Device {
        description: [f64; 9],
        speed: f64,
        places: Vec<Place>,
        name: &'static str,
        held: Option<u32>,
        counts: BTreeMap<u8, bool>,
    }

    fn bytes(device: &Device) -> Vec<u8> {
        let mut bytes = Vec::new();
        append(device, &mut bytes).unwrap();
        bytes
    }

    fn device() -> Device {
        let places = vec![Place::Nowhere, Place::At(7), Place::Between { from: -1, to: 2 }];
        let counts = BTreeMap::from([(5, true)]);
        Device { description: [1.0; 9], speed: 0.5, places, name: "ab", held: Some(3), counts }
    }

    #[test]
    fn fingerprint_covers_every_field_of_the_state() {
        let expected: [&[u8]; 9] = [
            &0.5_f64.to_le_bytes(),
            &[3, 0, 0, 0, 0, 0, 0, 0],
            &[0, 0, 0, 0],
            &[1, 0, 0, 0, 7],
            &[2, 0, 0, 0, 0xFF, 0xFF, 2, 0],
            &[2, 0, 0, 0, 0, 0, 0, 0, b'a', b'b'],
            &[1, 3, 0, 0, 0],
            &[1, 0, 0, 0, 0, 0, 0, 0],
            &[5, 1],
        ];
        assert_eq!(bytes(&device()), expected.concat());
    }

    #[test]
    fn build_information_is_not_compared() {
        assert_eq!(bytes(&device()), bytes(&Device { description: [2.0; 9], ..device() }));
        assert_ne!(bytes(&device()), bytes(&Device { held: None, ..device() }));
        assert_ne!(bytes(&device()), bytes(&Device { speed: -0.5, ..device() }));
    }
}
