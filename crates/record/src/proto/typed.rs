//! Messages of structs: one definition for the fields, their protobuf descriptors, encoding and decoding.
//!
//! The messages of buffers have the schema of their records ([`super::descriptor`]). Those here have texts and
//! lists of any length, which a record cannot contain.

use std::borrow::Cow;

use prost_types::{DescriptorProto, FieldDescriptorProto, field_descriptor_proto::Type};

use super::{
    descriptor::{self, encode_set, field, file, repeated, typed_field},
    wire::{self, Fields},
};

pub trait Value {
    /// Descriptor of a field of this type. Messages that it requires are added to `messages`.
    fn describe(name: &str, number: i32, messages: &mut Vec<DescriptorProto>) -> FieldDescriptorProto;

    fn put(&self, number: u32, out: &mut Vec<u8>);

    /// Take a value from the wire. A list appends it. A value of another wire type is ignored.
    fn take(&mut self, value: wire::Value<'_>);
}

pub trait Message {
    const NAME: &'static str; // its name without the package

    /// Its fields, in the order of their numbers from 1.
    fn fields(messages: &mut Vec<DescriptorProto>) -> Vec<FieldDescriptorProto>;

    fn put_fields(&self, out: &mut Vec<u8>);

    /// Take the value of the field with this number. Fields of newer versions are ignored.
    fn take_field(&mut self, number: u64, value: wire::Value<'_>);
}

#[must_use]
pub fn name<M: Message>() -> String {
    format!("{}.{}", descriptor::PACKAGE, M::NAME)
}

/// The encoded `FileDescriptorSet` with a message and all messages that it contains.
#[must_use]
pub fn descriptor_set<M: Message>() -> Vec<u8> {
    let mut messages = Vec::new();
    add::<M>(&mut messages);
    encode_set(vec![file("rcs.proto", descriptor::PACKAGE, &[], messages)])
}

#[must_use]
pub fn encode(message: &impl Message) -> Vec<u8> {
    let mut out = Vec::new();
    message.put_fields(&mut out);
    out
}

/// The message in these bytes, up to the first malformed field. Missing fields have their defaults.
#[must_use]
pub fn decode<M: Message + Default>(data: &[u8]) -> M {
    let mut message = M::default();
    message.take(wire::Value::Bytes(data));
    message
}

fn add<M: Message>(messages: &mut Vec<DescriptorProto>) {
    if messages.iter().all(|known| known.name() != M::NAME) {
        let fields = M::fields(messages);
        messages.push(descriptor::message(M::NAME, fields));
    }
}

macro_rules! scalars {
    ($($of:ty: $kind:ident, |$value:ident, $number:ident, $out:ident| $put:expr, $wire:pat => $taken:expr;)+) => { $(
        impl Value for $of {
            fn describe(name: &str, number: i32, _: &mut Vec<DescriptorProto>) -> FieldDescriptorProto {
                field(name, number, Type::$kind)
            }

            fn put(&self, $number: u32, $out: &mut Vec<u8>) {
                let $value = self;
                $put
            }

            fn take(&mut self, value: wire::Value<'_>) {
                if let $wire = value {
                    *self = $taken;
                }
            }
        }
    )+ };
}

scalars! {
    bool: Bool, |value, number, out| wire::unsigned(number, u64::from(*value), out),
        wire::Value::Number(found) => found != 0;
    u32: Uint32, |value, number, out| wire::unsigned(number, u64::from(*value), out),
        wire::Value::Number(found) => u32::try_from(found).unwrap_or(u32::MAX);
    u64: Uint64, |value, number, out| wire::unsigned(number, *value, out),
        wire::Value::Number(found) => found;
    f64: Double, |value, number, out| wire::double(number, *value, out),
        wire::Value::Bytes(found) => found.try_into().map_or(0.0, f64::from_le_bytes);
    String: String, |value, number, out| wire::bytes(number, value.as_bytes(), out),
        wire::Value::Bytes(found) => String::from_utf8_lossy(found).into_owned();
    Cow<'static, str>: String, |value, number, out| wire::bytes(number, value.as_bytes(), out),
        wire::Value::Bytes(found) => Cow::Owned(String::from_utf8_lossy(found).into_owned());
}

impl<M: Message> Value for M {
    fn describe(name: &str, number: i32, messages: &mut Vec<DescriptorProto>) -> FieldDescriptorProto {
        add::<M>(messages);
        typed_field(name, number, Type::Message, &self::name::<M>())
    }

    fn put(&self, number: u32, out: &mut Vec<u8>) {
        wire::nested(number, out, |out| self.put_fields(out));
    }

    fn take(&mut self, value: wire::Value<'_>) {
        if let wire::Value::Bytes(data) = value {
            Fields(data).for_each(|(number, value)| self.take_field(number, value));
        }
    }
}

impl<V: Value + Default> Value for Vec<V> {
    fn describe(name: &str, number: i32, messages: &mut Vec<DescriptorProto>) -> FieldDescriptorProto {
        repeated(V::describe(name, number, messages))
    }

    fn put(&self, number: u32, out: &mut Vec<u8>) {
        self.iter().for_each(|value| value.put(number, out));
    }

    fn take(&mut self, value: wire::Value<'_>) {
        let mut next = V::default();
        next.take(value);
        self.push(next);
    }
}

/// Defines structs that are messages: the fields have the numbers 1, 2, 3 ... in their order.
macro_rules! messages {
    ($(
        $(#[$doc:meta])*
        $name:ident { $( $(#[$field_doc:meta])* $field:ident: $of:ty, )+ }
    )+) => { $(
        $(#[$doc])*
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct $name { $( $(#[$field_doc])* pub $field: $of, )+ }

        impl $crate::proto::typed::Message for $name {
            const NAME: &'static str = stringify!($name);

            fn fields(
                messages: &mut Vec<prost_types::DescriptorProto>,
            ) -> Vec<prost_types::FieldDescriptorProto> {
                let mut numbers = 1..;
                let mut number = || numbers.next().unwrap_or_default();
                vec![ $( <$of as $crate::proto::typed::Value>::describe(stringify!($field), number(), messages) ),+ ]
            }

            fn put_fields(&self, out: &mut Vec<u8>) {
                let mut numbers = 1..;
                $( $crate::proto::typed::Value::put(&self.$field, numbers.next().unwrap_or_default(), out); )+
            }

            fn take_field(&mut self, number: u64, value: $crate::proto::wire::Value<'_>) {
                let mut numbers = 1..;
                $( if numbers.next() == Some(number) {
                    return $crate::proto::typed::Value::take(&mut self.$field, value);
                } )+
            }
        }
    )+ };
}
pub(crate) use messages;

#[cfg(test)]
mod tests {
    use super::*;
    use prost::Message as _;
    use prost_types::{FileDescriptorSet, field_descriptor_proto::Label};

    messages! {
        /// For the test.
        Inner { is_on: bool, x: f64, }
        /// For the test.
        Outer { name: String, count: u32, list: Vec<Inner>, words: Vec<Cow<'static, str>>, one: Inner, }
    }

    #[test]
    fn descriptor_has_every_message_once_and_fields_in_order() {
        let set = FileDescriptorSet::decode(descriptor_set::<Outer>().as_slice()).unwrap();
        let messages = &set.file[0].message_type;
        assert_eq!(messages.iter().map(|it| it.name()).collect::<Vec<_>>(), ["Inner", "Outer"]);
        let fields: Vec<_> = messages[1]
            .field
            .iter()
            .map(|it| (it.number(), it.name(), it.label() == Label::Repeated))
            .collect();
        let expected = [
            (1, "name", false),
            (2, "count", false),
            (3, "list", true),
            (4, "words", true),
            (5, "one", false),
        ];
        assert_eq!(fields, expected);
        assert_eq!(messages[1].field[2].type_name(), ".rcs.Inner");
    }

    #[test]
    fn message_is_encoded_field_by_field() {
        let inner = |x| Inner { is_on: true, x };
        let message = Outer {
            name: "A".into(),
            count: 300,
            list: vec![inner(0.0), inner(1.0)],
            words: vec!["b".into(), "".into()],
            one: Inner::default(),
        };
        let expected: &[&[u8]] = &[
            b"\x0A\x01A",
            &[0x10, 0xAC, 0x02],
            &[0x1A, 11, 0x08, 1, 0x11, 0, 0, 0, 0, 0, 0, 0, 0],
            &[0x1A, 11, 0x08, 1, 0x11, 0, 0, 0, 0, 0, 0, 0xF0, 0x3F],
            b"\x22\x01b",
            &[0x22, 0],
            &[0x2A, 11, 0x08, 0, 0x11, 0, 0, 0, 0, 0, 0, 0, 0],
        ];
        assert_eq!(encode(&message), expected.concat());
        assert_eq!(decode::<Outer>(&expected.concat()), message);
    }

    #[test]
    fn unknown_fields_and_wrong_wire_types_are_ignored() {
        let mut data = encode(&Outer { count: 7, ..Outer::default() });
        wire::bytes(9, b"of a newer version", &mut data);
        wire::bytes(2, b"not a number", &mut data);
        let found = decode::<Outer>(&data);
        assert_eq!(found, Outer { count: 7, ..Outer::default() });
        assert_eq!(decode::<Outer>(&[0x0A, 200]), Outer::default(), "the text is cut off");
    }
}
