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
//!
//! The wrapping message gives each enum a scope of its own: protobuf forbids two enums of one scope to share
//! a variant.

use prost::Message as _;
use prost_types::{
    DescriptorProto, EnumDescriptorProto, EnumValueDescriptorProto, FieldDescriptorProto,
    FileDescriptorProto, FileDescriptorSet,
    field_descriptor_proto::{Label, Type},
};
use rcs_core::plain::{EnumSchema, RecordSchema, Schema};

/// Package of all messages of this project.
pub const PACKAGE: &str = "rcs";

/// Full name of the message of a record.
#[must_use]
pub fn message_name(record: &RecordSchema) -> String {
    format!("{PACKAGE}.{}", record.name)
}

/// The encoded `FileDescriptorSet` that describes the message of a record and all that it holds.
#[must_use]
pub fn descriptor_set(record: &RecordSchema) -> Vec<u8> {
    let mut messages = Vec::new();
    add_record(record, &mut messages);
    encode_set(vec![file("rcs.proto", PACKAGE, &[], messages)])
}

/// A `FileDescriptorSet` as it stands in an MCAP schema.
#[must_use]
pub fn encode_set(files: Vec<FileDescriptorProto>) -> Vec<u8> {
    FileDescriptorSet { file: files }.encode_to_vec()
}

/// A file with its package, the files it imports, and its messages.
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

/// A message with its fields.
#[must_use]
pub fn message(name: &str, fields: Vec<FieldDescriptorProto>) -> DescriptorProto {
    DescriptorProto { name: Some(name.into()), field: fields, ..DescriptorProto::default() }
}

/// A field of a kind that has no type of its own.
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

/// A field whose type is a message or an enum, by its full name.
#[must_use]
pub fn typed_field(name: &str, number: i32, kind: Type, of: &str) -> FieldDescriptorProto {
    FieldDescriptorProto { type_name: Some(format!(".{of}")), ..field(name, number, kind) }
}

/// The same field, repeated.
#[must_use]
pub fn repeated(field: FieldDescriptorProto) -> FieldDescriptorProto {
    FieldDescriptorProto { label: Some(Label::Repeated.into()), ..field }
}

/// An enum with codes and identifiers.
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

fn add_record(record: &RecordSchema, messages: &mut Vec<DescriptorProto>) {
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
        Schema::Record(record) => add_record(record, messages),
        Schema::Array(of, _) => add_schema(of, messages),
        Schema::Enum(of) if !known(of.name, messages) => messages.push(DescriptorProto {
            name: Some(of.name.into()),
            enum_type: vec![enumeration("Value", identifiers(of))],
            ..DescriptorProto::default()
        }),
        _ => {}
    }
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
        Schema::Record(of) => typed_field(name, number, Type::Message, &message_name(of)),
        Schema::Array(of, _) if **of == Schema::U8 => field(name, number, Type::Bytes),
        Schema::Array(of, _) => repeated(schema_field(name, number, of)),
    }
}

/// Code and identifier of each variant. Protobuf wants identifiers: every other character becomes `_`, the
/// empty text `NONE`, and a text that is then like an earlier one gets its code at the end.
#[must_use]
pub fn identifiers(of: &EnumSchema) -> Vec<(i32, String)> {
    let mut names: Vec<(i32, String)> = Vec::new();
    for (code, text) in of.variants {
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
        names.push((i32::from(*code), name));
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use rcs_core::interface::{CommonMemory, ExternalInputs, emove::EmoveCommand};
    use std::collections::BTreeMap;

    fn decoded(record: &'static RecordSchema) -> FileDescriptorProto {
        FileDescriptorSet::decode(descriptor_set(record).as_slice()).unwrap().file.remove(0)
    }

    #[test]
    fn a_command_has_its_fields_and_enums() {
        let file = decoded(EmoveCommand::RECORD);
        let command = &file.message_type[0];
        assert_eq!(command.name(), "EmoveCommand");
        let verb = command.field.iter().find(|field| field.name() == "command").unwrap();
        assert_eq!((verb.number(), verb.type_name()), (2, ".rcs.EmoveVerb.Value"));
        let verbs = file.message_type.iter().find(|message| message.name() == "EmoveVerb").unwrap();
        let names: Vec<_> = verbs.enum_type[0].value.iter().map(|value| value.name()).collect();
        assert_eq!(names[..3], ["NONE", "E_PAUSE", "MOV_TO_LOC"]);
    }

    #[test]
    fn every_type_is_there_and_every_identifier_is_legal() {
        for record in [CommonMemory::RECORD, ExternalInputs::RECORD] {
            let file = decoded(record);
            for message in &file.message_type {
                for field in message.field.iter().filter(|field| field.type_name.is_some()) {
                    let wanted = field.type_name().trim_start_matches(".rcs.").trim_end_matches(".Value");
                    assert!(known(wanted, &file.message_type), "{wanted} is missing");
                }
                for value in message.enum_type.iter().flat_map(|of| &of.value) {
                    let name = value.name();
                    assert!(!name.starts_with(|c: char| c.is_ascii_digit()), "{name}");
                    assert!(name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_'), "{name}");
                }
            }
        }
    }

    /// Messages are told apart by name only, so two records, or a record and an enum, must not share one.
    #[test]
    fn names_are_not_shared() {
        fn walk(schema: &'static Schema, seen: &mut BTreeMap<&'static str, String>) {
            let (name, content) = match schema {
                Schema::Array(of, _) => return walk(of, seen),
                Schema::Record(of) => (of.name, format!("{of:?}")),
                Schema::Enum(of) => (of.name, format!("{of:?}")),
                _ => return,
            };
            assert_eq!(*seen.entry(name).or_insert_with(|| content.clone()), content, "{name}");
            if let Schema::Record(of) = schema {
                of.fields.iter().for_each(|field| walk(&field.schema, seen));
            }
        }
        let mut seen = BTreeMap::new();
        for record in [CommonMemory::RECORD, ExternalInputs::RECORD] {
            record.fields.iter().for_each(|field| walk(&field.schema, &mut seen));
        }
        assert!(seen.len() > 20);
    }

    #[test]
    fn texts_that_are_alike_get_their_code() {
        const OF: EnumSchema =
            EnumSchema { name: "Test", variants: &[(0, ""), (1, "a-b"), (2, "a b"), (3, ">GO"), (4, "2nd")] };
        let names: Vec<String> = identifiers(&OF).into_iter().map(|(_, name)| name).collect();
        assert_eq!(names, ["NONE", "a_b", "a_b_2", "GO", "_2nd"]);
    }
}
