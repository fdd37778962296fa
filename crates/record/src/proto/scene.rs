//! `foxglove.SceneUpdate`: shapes, texts and lines that a viewer draws in frames.
//!
//! Primitives that this log never draws are omitted.

use prost_types::{DescriptorProto, EnumDescriptorProto, field_descriptor_proto::Type};

use super::{
    descriptor::{encode_set, enumeration, field, file, message, repeated, typed_field},
    foxglove::{Transform, doubles, put_doubles, timestamp, timestamp_field, timestamp_file},
    wire,
};

pub const SCENE_UPDATE: &str = "foxglove.SceneUpdate";

const GLB: &str = "model/gltf-binary";

const ALL: u64 = 1; // deletes all entities of a topic: `foxglove.SceneEntityDeletion.Type`

/// A colour: red, green, blue and opacity from 0 to 1.
pub type Colour = [f64; 4];

/// The shape of an entity, in its frame; metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Primitive<'a> {
    /// A GLB file: metres, Y up.
    Model(&'a [u8]),
    /// A text that faces the viewer: position, height of its letters, colour.
    Text(&'a str, [f64; 3], f64, Colour),
    /// A line through points: points, thickness, colour.
    Line(&'a [[f64; 3]], f64, Colour),
    Ball([f64; 3], f64, Colour),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entity<'a> {
    /// Its name: a later entity with the same name replaces it.
    pub id: &'a str,
    pub frame: &'a str, // to which it is attached
    pub primitive: Primitive<'a>,
    /// Keys and values that a viewer shows for the selected entity.
    pub facts: &'a [(&'a str, String)],
}

impl<'a> Entity<'a> {
    #[must_use]
    pub const fn new(id: &'a str, frame: &'a str, primitive: Primitive<'a>) -> Self {
        Self { id, frame, primitive, facts: &[] }
    }
}

#[must_use]
pub fn descriptor() -> Vec<u8> {
    let of = |name, number, kind: &str| typed_field(name, number, Type::Message, kind);
    let list = |name, number, kind: &str| repeated(of(name, number, kind));
    let duration =
        message("Duration", vec![field("seconds", 1, Type::Int64), field("nanos", 2, Type::Int32)]);
    let duration = file("google/protobuf/duration.proto", "google.protobuf", &[], vec![duration]);
    let pose = vec![of("position", 1, "foxglove.Vector3"), of("orientation", 2, "foxglove.Quaternion")];
    let model = vec![
        of("pose", 1, "foxglove.Pose"),
        of("scale", 2, "foxglove.Vector3"),
        of("color", 3, "foxglove.Color"),
        field("override_color", 4, Type::Bool),
        field("url", 5, Type::String),
        field("media_type", 6, Type::String),
        field("data", 7, Type::Bytes),
    ];
    let text = vec![
        of("pose", 1, "foxglove.Pose"),
        field("billboard", 2, Type::Bool),
        field("font_size", 3, Type::Double),
        field("scale_invariant", 4, Type::Bool),
        of("color", 5, "foxglove.Color"),
        field("text", 6, Type::String),
    ];
    let line = vec![
        typed_field("type", 1, Type::Enum, "foxglove.LinePrimitive.Type"),
        of("pose", 2, "foxglove.Pose"),
        field("thickness", 3, Type::Double),
        field("scale_invariant", 4, Type::Bool),
        list("points", 5, "foxglove.Point3"),
        of("color", 6, "foxglove.Color"),
        list("colors", 7, "foxglove.Color"),
        repeated(field("indices", 8, Type::Fixed32)),
    ];
    let ball = vec![
        of("pose", 1, "foxglove.Pose"),
        of("size", 2, "foxglove.Vector3"),
        of("color", 3, "foxglove.Color"),
    ];
    let strips = ["LINE_STRIP", "LINE_LOOP", "LINE_LIST"];
    let strips = enumeration("Type", (0..).zip(strips.map(str::to_owned)).collect());
    let line = DescriptorProto { enum_type: vec![strips], ..message("LinePrimitive", line) };
    let entity = vec![
        timestamp_field(),
        field("frame_id", 2, Type::String),
        field("id", 3, Type::String),
        of("lifetime", 4, "google.protobuf.Duration"),
        field("frame_locked", 5, Type::Bool),
        list("metadata", 6, "foxglove.KeyValuePair"),
        list("spheres", 9, "foxglove.SpherePrimitive"),
        list("lines", 11, "foxglove.LinePrimitive"),
        list("texts", 13, "foxglove.TextPrimitive"),
        list("models", 14, "foxglove.ModelPrimitive"),
    ];
    let update = vec![
        list("deletions", 1, "foxglove.SceneEntityDeletion"),
        list("entities", 2, "foxglove.SceneEntity"),
    ];
    let messages = vec![
        doubles("Vector3", &["x", "y", "z"]),
        doubles("Quaternion", &["x", "y", "z", "w"]),
        doubles("Color", &["r", "g", "b", "a"]),
        message("Pose", pose),
        doubles("Point3", &["x", "y", "z"]),
        message("KeyValuePair", vec![field("key", 1, Type::String), field("value", 2, Type::String)]),
        message("SpherePrimitive", ball),
        line,
        message("ModelPrimitive", model),
        message("TextPrimitive", text),
        message("SceneEntity", entity),
        deletion(),
        message("SceneUpdate", update),
    ];
    let imports = ["google/protobuf/timestamp.proto", "google/protobuf/duration.proto"];
    let update = file("foxglove/SceneUpdate.proto", "foxglove", &imports, messages);
    encode_set(vec![timestamp_file(), duration, update])
}

fn deletion() -> DescriptorProto {
    let kinds: EnumDescriptorProto =
        enumeration("Type", vec![(0, "MATCHING_ID".to_owned()), (1, "ALL".to_owned())]);
    let kind = typed_field("type", 2, Type::Enum, "foxglove.SceneEntityDeletion.Type");
    DescriptorProto {
        enum_type: vec![kinds],
        ..message("SceneEntityDeletion", vec![timestamp_field(), kind, field("id", 3, Type::String)])
    }
}

/// Append the deletion of all earlier entities to a `SceneUpdate`. `time` in nanoseconds since 1970.
pub fn put_clear(time: u64, out: &mut Vec<u8>) {
    wire::nested(1, out, |out| {
        timestamp(time, out);
        wire::unsigned(2, ALL, out);
    });
}

/// Append one entity, which remains until it is replaced, to a `SceneUpdate`. `time` in nanoseconds since 1970.
pub fn put_entity(time: u64, entity: &Entity<'_>, out: &mut Vec<u8>) {
    wire::nested(2, out, |out| {
        timestamp(time, out);
        wire::bytes(2, entity.frame.as_bytes(), out);
        wire::bytes(3, entity.id.as_bytes(), out);
        wire::unsigned(5, 1, out);
        for (key, value) in entity.facts {
            wire::nested(6, out, |out| {
                wire::bytes(1, key.as_bytes(), out);
                wire::bytes(2, value.as_bytes(), out);
            });
        }
        match entity.primitive {
            Primitive::Model(glb) => wire::nested(14, out, |out| {
                pose(&[0.0; 3], out);
                wire::nested(2, out, |out| put_doubles(&[1.0; 3], out));
                wire::bytes(6, GLB.as_bytes(), out);
                wire::bytes(7, glb, out);
            }),
            Primitive::Text(text, position, height, colour) => wire::nested(13, out, |out| {
                pose(&position, out);
                wire::unsigned(2, 1, out);
                wire::double(3, height, out);
                wire::nested(5, out, |out| put_doubles(&colour, out));
                wire::bytes(6, text.as_bytes(), out);
            }),
            Primitive::Line(points, thickness, colour) => wire::nested(11, out, |out| {
                nested_pose(2, &[0.0; 3], out);
                wire::double(3, thickness, out);
                for point in points {
                    wire::nested(5, out, |out| put_doubles(point, out));
                }
                wire::nested(6, out, |out| put_doubles(&colour, out));
            }),
            Primitive::Ball(middle, diameter, colour) => wire::nested(9, out, |out| {
                pose(&middle, out);
                wire::nested(2, out, |out| put_doubles(&[diameter; 3], out));
                wire::nested(3, out, |out| put_doubles(&colour, out));
            }),
        }
    });
}

/// A pose without rotation, as the first field.
fn pose(position: &[f64; 3], out: &mut Vec<u8>) {
    nested_pose(1, position, out);
}

/// A pose without rotation, as a field.
fn nested_pose(field: u32, position: &[f64; 3], out: &mut Vec<u8>) {
    wire::nested(field, out, |out| {
        wire::nested(1, out, |out| put_doubles(position, out));
        wire::nested(2, out, |out| put_doubles(&Transform::IDENTITY.rotation, out));
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::proto::wire::{Fields, Value};
    use prost::Message as _;
    use prost_types::FileDescriptorSet;

    /// The bytes of a field of a message.
    fn part(data: &[u8], number: u64) -> &[u8] {
        let found = Fields(data).find_map(|field| match field {
            (n, Value::Bytes(bytes)) if n == number => Some(bytes),
            _ => None,
        });
        found.unwrap_or_else(|| panic!("no field {number} in {data:?}"))
    }

    #[test]
    fn scene_descriptors_contain_all_named_types() {
        let set = FileDescriptorSet::decode(descriptor().as_slice()).unwrap();
        let names: Vec<String> = set
            .file
            .iter()
            .flat_map(|file| {
                file.message_type.iter().map(|message| format!(".{}.{}", file.package(), message.name()))
            })
            .collect();
        for message in set.file.iter().flat_map(|file| &file.message_type) {
            for field in message.field.iter().filter(|field| field.r#type() == Type::Message) {
                assert!(names.iter().any(|name| name == field.type_name()), "{}", field.type_name());
            }
        }
        assert!(names.contains(&format!(".{SCENE_UPDATE}")));
    }

    #[test]
    fn model_and_text_have_the_fields_of_the_schema() {
        let mut out = Vec::new();
        let entity = Entity::new("arm", "upper_arm", Primitive::Model(b"glTF"));
        put_entity(1_000_000_002, &entity, &mut out);
        let model = part(&out, 2);
        assert_eq!((part(model, 2), part(model, 3)), (&b"upper_arm"[..], &b"arm"[..]));
        assert!(Fields(model).any(|field| field == (5, Value::Number(1))), "it moves with its frame");
        assert_eq!(part(part(model, 14), 6), GLB.as_bytes());
        assert_eq!(part(part(model, 14), 7), b"glTF");
        out.clear();
        let text = Primitive::Text("vise", [0.0, 0.0, 2.0], 0.06, [1.0; 4]);
        put_entity(0, &Entity { primitive: text, ..entity }, &mut out);
        assert_eq!(part(part(part(&out, 2), 13), 6), b"vise");
        out.clear();
        let line = Primitive::Line(&[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], 0.01, [1.0; 4]);
        put_entity(0, &Entity { primitive: line, ..entity }, &mut out);
        let points = Fields(part(part(&out, 2), 11)).filter(|field| matches!(field, (5, _))).count();
        assert_eq!(points, 2);
    }
}
