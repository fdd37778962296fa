//! Converts a record's byte image into a protobuf message, described by [`super::descriptor`].

use rcs_core::{
    plain::{Schema, StructSchema, UnionSchema},
    reflect,
};

use super::{descriptor, wire};

/// Append the message of `record`; `image` is its byte image.
pub fn encode(record: &StructSchema, mut image: &[u8], out: &mut Vec<u8>) {
    for (number, field) in (1..).zip(record.fields) {
        let (bytes, rest) = image.split_at_checked(field.schema.size()).unwrap_or((image, &[]));
        encode_field(number, &field.schema, bytes, out);
        image = rest;
    }
}

fn encode_field(number: u32, schema: &Schema, bytes: &[u8], out: &mut Vec<u8>) {
    match schema {
        Schema::U8 | Schema::U16 | Schema::U32 | Schema::U64 | Schema::Bool | Schema::Enum(_) => {
            wire::unsigned(number, reflect::unsigned(bytes), out);
        }
        Schema::I16 | Schema::I32 => wire::signed(number, reflect::signed(bytes), out),
        Schema::F64 => wire::double(number, f64::from_bits(reflect::unsigned(bytes)), out),
        Schema::Text(_) => {
            let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
            wire::bytes(number, bytes.get(..end).unwrap_or_default(), out);
        }
        Schema::Struct(record) => wire::nested(number, out, |out| encode(record, bytes, out)),
        Schema::Option(of) => match bytes.split_first() {
            None | Some((0, _)) => {}
            Some((_, value)) => encode_field(number, of, value, out),
        },
        Schema::Union(of) => wire::nested(number, out, |out| encode_union(of, bytes, out)),
        Schema::Array(Schema::U8, _) => wire::bytes(number, bytes, out),
        Schema::Array(of @ Schema::Option(_), _) => {
            for item in bytes.chunks_exact(of.size().max(1)) {
                wire::nested(number, out, |out| encode_field(1, of, item, out));
            }
        }
        Schema::Array(
            of @ (Schema::Text(_) | Schema::Struct(_) | Schema::Union(_) | Schema::Array(..)),
            _,
        ) => {
            bytes.chunks_exact(of.size().max(1)).for_each(|item| encode_field(number, of, item, out));
        }
        Schema::Array(of, _) => wire::nested(number, out, |out| {
            bytes.chunks_exact(of.size().max(1)).for_each(|item| encode_packed(of, item, out));
        }),
    }
}

fn encode_union(of: &UnionSchema, bytes: &[u8], out: &mut Vec<u8>) {
    let Some((code, carried)) = bytes.split_first() else { return };
    wire::unsigned(1, u64::from(*code), out);
    let variant = of.variants.iter().find(|variant| variant.code == *code);
    if let Some(payload) = variant.and_then(|variant| variant.payload.as_ref()) {
        let bytes = carried.get(..payload.size()).unwrap_or_default();
        encode_field(descriptor::payload_number(*code).into(), payload, bytes, out);
    }
}

/// Encode an element of a packed array: the value without its field number.
fn encode_packed(schema: &Schema, bytes: &[u8], out: &mut Vec<u8>) {
    match schema {
        Schema::F64 => out.extend_from_slice(bytes),
        Schema::I16 | Schema::I32 => wire::put_varint(wire::zigzag(reflect::signed(bytes)), out),
        _ => wire::put_varint(reflect::unsigned(bytes), out),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rcs_core::{Plain, plain::Writer};

    /// For the test.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
    enum Light {
        Off,
        On,
    }

    /// For the test.
    #[derive(Clone, Copy, Debug, PartialEq, Plain)]
    struct Inner {
        at: i16,
    }

    /// For the test.
    #[derive(Clone, Copy, Debug, PartialEq, Plain)]
    struct Lamp {
        number: u16,
        light: Light,
        hours: [i32; 2],
        name: rcs_core::name::Name10,
        raw: [u8; 3],
        inner: [Inner; 2],
        level: f64,
        lit: bool,
    }

    #[test]
    fn a_message_field_by_field() {
        let lamp = Lamp {
            number: 300,
            light: Light::On,
            hours: [-1, 200],
            name: rcs_core::name::Name10::new("LAMP").unwrap(),
            raw: [9, 0, 7],
            inner: [Inner { at: 0 }, Inner { at: -2 }],
            level: 0.0,
            lit: true,
        };
        let mut image = vec![0xA5; Lamp::SIZE];
        lamp.encode(&mut Writer::new(&mut image));
        let mut out = Vec::new();
        encode(Lamp::STRUCT, &image, &mut out);
        let expected: &[&[u8]] = &[
            &[0x08, 0xAC, 0x02],             // number
            &[0x10, 0x01],                   // light
            &[0x1A, 0x03, 0x01, 0x90, 0x03], // hours, packed zigzag
            b"\x22\x04LAMP",                 // name
            &[0x2A, 0x03, 9, 0, 7],          // raw
            &[0x32, 0x02, 0x08, 0x00],       // inner[0]: a zero is written
            &[0x32, 0x02, 0x08, 0x03],       // inner[1]
            &[0x39, 0, 0, 0, 0, 0, 0, 0, 0], // level
            &[0x40, 0x01],                   // lit
        ];
        assert_eq!(out, expected.concat());
    }

    /// For the test.
    #[derive(Clone, Copy, Debug, PartialEq, Plain)]
    enum Goal {
        Nowhere,
        At(Inner),
        Count(u16),
    }

    /// For the test.
    #[derive(Clone, Copy, Debug, PartialEq, Plain)]
    struct Order {
        number: Option<u16>,
        from: Option<Inner>,
        seats: [Option<Light>; 2],
        goal: Goal,
        last: Option<Goal>,
    }

    fn encoded(order: &Order) -> Vec<u8> {
        let mut image = vec![0xA5; Order::SIZE];
        order.encode(&mut Writer::new(&mut image));
        let mut out = Vec::new();
        encode(Order::STRUCT, &image, &mut out);
        out
    }

    #[test]
    fn absent_value_is_not_written() {
        let expected: &[&[u8]] = &[
            &[0x1A, 0x00],             // seats[0]
            &[0x1A, 0x00],             // seats[1]
            &[0x22, 0x02, 0x08, 0x00], // goal: nowhere
        ];
        assert_eq!(encoded(&Order::default()), expected.concat());
    }

    #[test]
    fn present_zero_is_written() {
        let order = Order {
            number: Some(0),
            from: Some(Inner { at: -2 }),
            seats: [None, Some(Light::On)],
            goal: Goal::Count(300),
            last: Some(Goal::At(Inner { at: 0 })),
        };
        let expected: &[&[u8]] = &[
            &[0x08, 0x00],                               // number
            &[0x12, 0x02, 0x08, 0x03],                   // from
            &[0x1A, 0x00],                               // seats[0]: none
            &[0x1A, 0x02, 0x08, 0x01],                   // seats[1]
            &[0x22, 0x05, 0x08, 0x02, 0x20, 0xAC, 0x02], // goal: count, field 4
            &[0x2A, 0x06, 0x08, 0x01, 0x1A, 0x02, 8, 0], // last: at, field 3
        ];
        assert_eq!(encoded(&order), expected.concat());
    }
}
