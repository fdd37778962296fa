//! A record's [`Schema`] as protobuf descriptors.
//!
//! | in the schema            | in protobuf                                                          |
//! |--------------------------|----------------------------------------------------------------------|
//! | record                   | message of the same name, field *n* has number *n* from 1            |
//! | `u8` … `u64`             | `uint32`, `uint64`                                                   |
//! | `i16`, `i32`             | `sint32`                                                             |
//! | `f64`, `bool`            | `double`, `bool`                                                     |
//! | name                     | `string`                                                             |
//! | enum                     | enum `Value` in a message with the enum's name, variants by their text |
//! | array of bytes           | `bytes`                                                              |
//! | array                    | `repeated`, packed where protobuf can                                |
//! | option                   | `optional`; an absent value is not written                           |
//! | option in an array       | message `OptionOfType` with the field `value`                        |
//! | union                    | message of the same name: `kind` is an enum of the variants by their |
//! |                          | text, and an optional field for what each carries, number code + 2.  |
//! |                          | The enum is in a nested message: a variant and its field are alike   |
//!
//! The wrapping message gives each enum its own scope: protobuf forbids equal variants of two enums in one scope. A
//! field of a union is named after its variant, as in [`crate::layout`].

use prost::Message as _;
use prost_types::{
    DescriptorProto, EnumDescriptorProto, EnumValueDescriptorProto, FieldDescriptorProto,
    FileDescriptorProto, FileDescriptorSet, OneofDescriptorProto,
    field_descriptor_proto::{Label, Type},
};
use rcs_core::plain::{EnumSchema, Schema, StructSchema, UnionSchema};

pub const PACKAGE: &str = "rcs";

/// The field of a union's message with the variant.
pub const KIND: &str = "kind";

#[must_use]
pub fn message_name(record: &StructSchema) -> String {
    format!("{PACKAGE}.{}", record.name)
}

/// The encoded `FileDescriptorSet` with the message of a record and all messages that it contains.
#[must_use]
pub fn descriptor_set(record: &StructSchema) -> Vec<u8> {
    let mut messages = Vec::new();
    add_record(record, &mut messages);
    encode_set(vec![file("rcs.proto", PACKAGE, &[], messages)])
}

#[must_use]
pub fn encode_set(files: Vec<FileDescriptorProto>) -> Vec<u8> {
    FileDescriptorSet { file: files }.encode_to_vec()
}

#[must_use]
pub fn file(
    name: &str,
    package: &str,
    imports: &[&str],
    messages: Vec<DescriptorProto>,
) -> FileDescriptorProto {
    FileDescriptorProto {
        name: Some(name.into()),
        package: Some(package.into()),
        dependency: imports.iter().map(|import| (*import).to_owned()).collect(),
        message_type: messages,
        syntax: Some("proto3".into()),
        ..FileDescriptorProto::default()
    }
}

/// A message with its fields. Protobuf requires a oneof for each field that is [`optional`].
#[must_use]
pub fn message(name: &str, mut fields: Vec<FieldDescriptorProto>) -> DescriptorProto {
    let mut oneofs = Vec::new();
    for (index, field) in (0..).zip(fields.iter_mut().filter(|field| field.proto3_optional())) {
        field.oneof_index = Some(index);
        let name = Some(format!("_{}", field.name()));
        oneofs.push(OneofDescriptorProto { name, ..OneofDescriptorProto::default() });
    }
    DescriptorProto {
        name: Some(name.into()),
        field: fields,
        oneof_decl: oneofs,
        ..DescriptorProto::default()
    }
}

#[must_use]
pub fn field(name: &str, number: i32, kind: Type) -> FieldDescriptorProto {
    FieldDescriptorProto {
        name: Some(name.into()),
        number: Some(number),
        label: Some(Label::Optional.into()),
        r#type: Some(kind.into()),
        ..FieldDescriptorProto::default()
    }
}

#[must_use]
pub fn typed_field(name: &str, number: i32, kind: Type, of: &str) -> FieldDescriptorProto {
    FieldDescriptorProto { type_name: Some(format!(".{of}")), ..field(name, number, kind) }
}

#[must_use]
pub fn repeated(field: FieldDescriptorProto) -> FieldDescriptorProto {
    FieldDescriptorProto { label: Some(Label::Repeated.into()), ..field }
}

/// The field as optional. Messages and repeated fields need no mark, because they can be absent or empty.
#[must_use]
pub fn optional(field: FieldDescriptorProto) -> FieldDescriptorProto {
    let absent_anyway = field.r#type() == Type::Message || field.label() == Label::Repeated;
    FieldDescriptorProto { proto3_optional: (!absent_anyway).then_some(true), ..field }
}

#[must_use]
pub fn enumeration(name: &str, values: Vec<(i32, String)>) -> EnumDescriptorProto {
    let value = |(number, name)| EnumValueDescriptorProto {
        name: Some(name),
        number: Some(number),
        ..EnumValueDescriptorProto::default()
    };
    EnumDescriptorProto {
        name: Some(name.into()),
        value: values.into_iter().map(value).collect(),
        ..EnumDescriptorProto::default()
    }
}

fn known(name: &str, messages: &[DescriptorProto]) -> bool {
    messages.iter().any(|message| message.name() == name)
}

fn add_record(record: &StructSchema, messages: &mut Vec<DescriptorProto>) {
    if known(record.name, messages) {
        return;
    }
    let fields =
        (1..).zip(record.fields).map(|(number, field)| schema_field(field.name, number, &field.schema));
    messages.push(message(record.name, fields.collect()));
    for field in record.fields {
        add_schema(&field.schema, messages);
    }
}

fn add_schema(schema: &'static Schema, messages: &mut Vec<DescriptorProto>) {
    match schema {
        Schema::Struct(record) => add_record(record, messages),
        Schema::Array(of, _) => {
            if matches!(of, Schema::Option(_)) && !known(&element_name(of), messages) {
                messages.push(message(&element_name(of), vec![schema_field("value", 1, of)]));
            }
            add_schema(of, messages);
        }
        Schema::Option(of) => add_schema(of, messages),
        Schema::Enum(of) if !known(of.name, messages) => messages.push(DescriptorProto {
            enum_type: vec![enumeration("Value", enum_identifiers(of))],
            ..message(of.name, Vec::new())
        }),
        Schema::Union(of) => add_union(of, messages),
        _ => {}
    }
}

fn add_union(of: &'static UnionSchema, messages: &mut Vec<DescriptorProto>) {
    if known(of.name, messages) {
        return;
    }
    let payloads = || of.variants.iter().filter_map(|variant| variant.payload.as_ref());
    let carried = of.variants.iter().filter_map(|variant| {
        let number = payload_number(variant.code).into();
        Some(optional(schema_field(variant.name, number, variant.payload.as_ref()?)))
    });
    let kind = typed_field(KIND, 1, Type::Enum, &format!("{PACKAGE}.{}.Kind.Value", of.name));
    let texts = of.variants.iter().map(|variant| (variant.code, variant.text));
    messages.push(DescriptorProto {
        nested_type: vec![DescriptorProto {
            enum_type: vec![enumeration("Value", identifiers(texts))],
            ..message("Kind", Vec::new())
        }],
        ..message(of.name, std::iter::once(kind).chain(carried).collect())
    });
    payloads().for_each(|payload| add_schema(payload, messages));
}

/// Number of the field for the value of a variant.
#[must_use]
pub fn payload_number(code: u8) -> u16 {
    u16::from(code) + 2
}

fn element_name(option: &Schema) -> String {
    fn type_name(schema: &Schema) -> String {
        match schema {
            Schema::Enum(of) => of.name.to_owned(),
            Schema::Struct(of) => of.name.to_owned(),
            Schema::Union(of) => of.name.to_owned(),
            Schema::Text(_) => "Text".to_owned(),
            Schema::Array(of, _) => format!("ArrayOf{}", type_name(of)),
            Schema::Option(of) => format!("OptionOf{}", type_name(of)),
            number => format!("{number:?}"),
        }
    }
    type_name(option)
}

fn schema_field(name: &str, number: i32, schema: &'static Schema) -> FieldDescriptorProto {
    match schema {
        Schema::U8 | Schema::U16 | Schema::U32 => field(name, number, Type::Uint32),
        Schema::U64 => field(name, number, Type::Uint64),
        Schema::I16 | Schema::I32 => field(name, number, Type::Sint32),
        Schema::F64 => field(name, number, Type::Double),
        Schema::Bool => field(name, number, Type::Bool),
        Schema::Text(_) => field(name, number, Type::String),
        Schema::Enum(of) => typed_field(name, number, Type::Enum, &format!("{PACKAGE}.{}.Value", of.name)),
        Schema::Struct(of) => typed_field(name, number, Type::Message, &message_name(of)),
        Schema::Union(of) => typed_field(name, number, Type::Message, &format!("{PACKAGE}.{}", of.name)),
        Schema::Option(of) => optional(schema_field(name, number, of)),
        Schema::Array(of, _) if **of == Schema::U8 => field(name, number, Type::Bytes),
        Schema::Array(of @ Schema::Option(_), _) => {
            let element = format!("{PACKAGE}.{}", element_name(of));
            repeated(typed_field(name, number, Type::Message, &element))
        }
        Schema::Array(of, _) => repeated(schema_field(name, number, of)),
    }
}

fn enum_identifiers(of: &EnumSchema) -> Vec<(i32, String)> {
    identifiers(of.variants.iter().map(|variant| (variant.code, variant.text)))
}

/// Code and identifier of each variant. Every character that protobuf forbids becomes `_`, the empty text `NONE`; an
/// identifier that exists already gets its code as a suffix.
#[must_use]
pub fn identifiers<'a>(variants: impl Iterator<Item = (u8, &'a str)>) -> Vec<(i32, String)> {
    let mut names: Vec<(i32, String)> = Vec::new();
    for (code, text) in variants {
        let plain: String = text.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        let mut name = plain.trim_matches('_').to_owned();
        if name.is_empty() {
            name = "NONE".into();
        } else if name.starts_with(|c: char| c.is_ascii_digit()) {
            name.insert(0, '_');
        }
        if names.iter().any(|(_, earlier)| *earlier == name) {
            name = format!("{name}_{code}");
        }
        names.push((i32::from(code), name));
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{CommonMemory, ExternalInputs, emove::EmoveCommand};
    use rcs_core::{Plain, plain::VariantSchema};
    use std::collections::{BTreeMap, BTreeSet};

    #[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
    enum Light {
        Off,
        On,
    }

    #[derive(Clone, Copy, Debug, PartialEq, Plain)]
    struct Spot {
        x: i16,
    }

    #[derive(Clone, Copy, Debug, PartialEq, Plain)]
    enum Goal {
        Nowhere,
        #[text = "at a spot"]
        At(Spot),
        Kind(Light),
        Path([f64; 2]),
    }

    #[derive(Clone, Copy, Debug, PartialEq, Plain)]
    struct Order {
        number: Option<u16>,
        light: Option<Light>,
        from: Option<Spot>,
        hours: Option<[i32; 2]>,
        seats: [Option<Spot>; 2],
        goal: Goal,
        last: Option<Goal>,
    }

    fn decoded(record: &'static StructSchema) -> FileDescriptorProto {
        FileDescriptorSet::decode(descriptor_set(record).as_slice()).unwrap().file.remove(0)
    }

    #[test]
    fn command_has_its_fields_and_enums() {
        let file = decoded(EmoveCommand::STRUCT);
        let command = &file.message_type[0];
        assert_eq!(command.name(), "EmoveCommand");
        let verb = command.field.iter().find(|field| field.name() == "command").unwrap();
        assert_eq!((verb.number(), verb.type_name()), (2, ".rcs.EmoveVerb.Value"));
        let verbs = file.message_type.iter().find(|message| message.name() == "EmoveVerb").unwrap();
        let names: Vec<_> = verbs.enum_type[0].value.iter().map(|value| value.name()).collect();
        assert_eq!(names[..3], ["NONE", "E_PAUSE", "MOV_TO_LOC"]);
    }

    #[test]
    fn every_type_exists_and_every_identifier_is_legal() {
        for record in [CommonMemory::STRUCT, ExternalInputs::STRUCT, Order::STRUCT] {
            let file = decoded(record);
            for message in &file.message_type {
                for field in message.field.iter().filter(|field| field.type_name.is_some()) {
                    let wanted = field.type_name().trim_start_matches(".rcs.");
                    let wanted = wanted.trim_end_matches(".Value").trim_end_matches(".Kind");
                    assert!(known(wanted, &file.message_type), "{wanted} is missing");
                }
                for (index, oneof) in (0..).zip(&message.oneof_decl) {
                    let mut fields = message.field.iter().filter(|field| field.oneof_index == Some(index));
                    let field = fields.next().unwrap();
                    assert!(field.proto3_optional() && oneof.name() == format!("_{}", field.name()));
                    assert!(fields.next().is_none(), "protobuf wants an oneof for each optional field");
                }
                // Fields, types, and the values of enums share the scope of their message.
                let nested = message.nested_type.iter().map(DescriptorProto::name);
                let enums = message.enum_type.iter().flat_map(|of| of.value.iter().map(|value| value.name()));
                let mut names: Vec<&str> = message.field.iter().map(|field| field.name()).collect();
                names.extend(nested.chain(enums));
                let unique: BTreeSet<&str> = names.iter().copied().collect();
                assert_eq!(unique.len(), names.len(), "{} has a name twice: {names:?}", message.name());
                let own = std::iter::once(message).chain(&message.nested_type);
                for value in own.flat_map(|message| &message.enum_type).flat_map(|of| &of.value) {
                    let name = value.name();
                    assert!(!name.starts_with(|c: char| c.is_ascii_digit()), "{name}");
                    assert!(name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_'), "{name}");
                }
            }
        }
    }

    /// Messages are distinguished only by name, so two records, or a record and an enum, must not share a name.
    #[test]
    fn names_are_not_shared() {
        fn walk(schema: &'static Schema, seen: &mut BTreeMap<&'static str, String>) {
            let (name, content) = match schema {
                Schema::Array(of, _) | Schema::Option(of) => return walk(of, seen),
                Schema::Struct(of) => (of.name, format!("{of:?}")),
                Schema::Enum(of) => (of.name, format!("{of:?}")),
                Schema::Union(of) => (of.name, format!("{of:?}")),
                _ => return,
            };
            assert_eq!(*seen.entry(name).or_insert_with(|| content.clone()), content, "{name}");
            match schema {
                Schema::Struct(of) => of.fields.iter().for_each(|field| walk(&field.schema, seen)),
                Schema::Union(of) => {
                    let payloads = of.variants.iter().filter_map(|variant| variant.payload.as_ref());
                    payloads.for_each(|payload| walk(payload, seen));
                }
                _ => {}
            }
        }
        let mut seen = BTreeMap::new();
        for record in [CommonMemory::STRUCT, ExternalInputs::STRUCT] {
            record.fields.iter().for_each(|field| walk(&field.schema, &mut seen));
        }
        assert!(seen.len() > 20);
    }

    /// Field name, number, type or name of the type, and true for optional and repeated fields.
    fn fields(message: &DescriptorProto) -> Vec<(&str, i32, &str, &str)> {
        fn told(field: &FieldDescriptorProto) -> (&str, i32, &str, &str) {
            let kind = field.type_name.as_deref().unwrap_or_else(|| field.r#type().as_str_name());
            let presence = match (field.proto3_optional(), field.label()) {
                (true, _) => "optional",
                (false, Label::Repeated) => "repeated",
                (false, _) => "",
            };
            (field.name(), field.number(), kind, presence)
        }
        message.field.iter().map(told).collect()
    }

    #[test]
    fn options_are_optional_fields() {
        let file = decoded(Order::STRUCT);
        let expected = [
            ("number", 1, "TYPE_UINT32", "optional"),
            ("light", 2, ".rcs.Light.Value", "optional"),
            ("from", 3, ".rcs.Spot", ""),
            ("hours", 4, "TYPE_SINT32", "repeated"),
            ("seats", 5, ".rcs.OptionOfSpot", "repeated"),
            ("goal", 6, ".rcs.Goal", ""),
            ("last", 7, ".rcs.Goal", ""),
        ];
        assert_eq!(fields(&file.message_type[0]), expected);
        let element = file.message_type.iter().find(|message| message.name() == "OptionOfSpot").unwrap();
        assert_eq!(fields(element), [("value", 1, ".rcs.Spot", "")]);
    }

    #[test]
    fn union_has_a_kind_and_payload_fields() {
        let file = decoded(Order::STRUCT);
        let goal = file.message_type.iter().find(|message| message.name() == "Goal").unwrap();
        let expected = [
            ("kind", 1, ".rcs.Goal.Kind.Value", ""),
            ("at_a_spot", 3, ".rcs.Spot", ""),
            ("kind_2", 4, ".rcs.Light.Value", "optional"),
            ("path", 5, "TYPE_DOUBLE", "repeated"),
        ];
        assert_eq!(fields(goal), expected);
        let kinds: Vec<_> = goal.nested_type[0].enum_type[0].value.iter().map(|value| value.name()).collect();
        assert_eq!(kinds, ["nowhere", "at_a_spot", "kind", "path"]);
    }

    #[test]
    fn equal_identifiers_get_their_code() {
        const fn variant(code: u8, text: &'static str) -> VariantSchema {
            VariantSchema { code, name: "", text, doc: "" }
        }
        const OF: EnumSchema = EnumSchema {
            name: "Test",
            variants: &[
                variant(0, ""),
                variant(1, "a-b"),
                variant(2, "a b"),
                variant(3, ">GO"),
                variant(4, "2nd"),
            ],
        };
        let names: Vec<String> = enum_identifiers(&OF).into_iter().map(|(_, name)| name).collect();
        assert_eq!(names, ["NONE", "a_b", "a_b_2", "GO", "_2nd"]);
    }
}
