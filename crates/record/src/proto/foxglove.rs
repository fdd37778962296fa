//! Messages of the `foxglove` package, which viewers recognize by name, with the numbers of foxglove's schema
//! repository. Fields that this log never fills are not described.

use prost_types::{DescriptorProto, FileDescriptorProto, field_descriptor_proto::Type};

use super::{
    descriptor::{encode_set, enumeration, field, file, message, repeated, typed_field},
    wire::{self, Value},
};

pub const FRAME_TRANSFORMS: &str = "foxglove.FrameTransforms";
pub const COMPRESSED_IMAGE: &str = "foxglove.CompressedImage";
pub const LOG: &str = "foxglove.Log";

/// Severity of a log line; the codes are those of `foxglove.Log`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    Debug = 1,
    #[default]
    Info = 2,
    /// An unusual event without damage so far.
    Warning = 3,
    Error = 4,
}

impl Level {
    /// The level with a code. An unknown code is an error.
    #[must_use]
    pub const fn from_code(code: u64) -> Self {
        match code {
            1 => Self::Debug,
            2 => Self::Info,
            3 => Self::Warning,
            _ => Self::Error,
        }
    }
}

/// Pose of a frame in another: metres, and a unit quaternion x, y, z, w.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    pub position: [f64; 3], // origin of the frame, metres
    pub rotation: [f64; 4],
}

impl Transform {
    pub const IDENTITY: Self = Self { position: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0] };
}

pub(super) fn timestamp_file() -> FileDescriptorProto {
    let fields = vec![field("seconds", 1, Type::Int64), field("nanos", 2, Type::Int32)];
    let timestamp = message("Timestamp", fields);
    file("google/protobuf/timestamp.proto", "google.protobuf", &[], vec![timestamp])
}

pub(super) fn timestamp_field() -> prost_types::FieldDescriptorProto {
    typed_field("timestamp", 1, Type::Message, "google.protobuf.Timestamp")
}

pub(super) fn doubles(name: &str, fields: &[&str]) -> DescriptorProto {
    let fields = (1..).zip(fields).map(|(number, name)| field(name, number, Type::Double));
    message(name, fields.collect())
}

#[must_use]
pub fn frame_transforms_descriptor() -> Vec<u8> {
    let transform = message(
        "FrameTransform",
        vec![
            timestamp_field(),
            field("parent_frame_id", 2, Type::String),
            field("child_frame_id", 3, Type::String),
            typed_field("translation", 4, Type::Message, "foxglove.Vector3"),
            typed_field("rotation", 5, Type::Message, "foxglove.Quaternion"),
        ],
    );
    let transforms = message(
        "FrameTransforms",
        vec![repeated(typed_field("transforms", 1, Type::Message, "foxglove.FrameTransform"))],
    );
    let messages = vec![
        doubles("Vector3", &["x", "y", "z"]),
        doubles("Quaternion", &["x", "y", "z", "w"]),
        transform,
        transforms,
    ];
    let imports = ["google/protobuf/timestamp.proto"];
    encode_set(vec![timestamp_file(), file("foxglove/FrameTransforms.proto", "foxglove", &imports, messages)])
}

#[must_use]
pub fn compressed_image_descriptor() -> Vec<u8> {
    let fields = vec![
        timestamp_field(),
        field("data", 2, Type::Bytes),
        field("format", 3, Type::String),
        field("frame_id", 4, Type::String),
    ];
    let image = message("CompressedImage", fields);
    let imports = ["google/protobuf/timestamp.proto"];
    encode_set(vec![
        timestamp_file(),
        file("foxglove/CompressedImage.proto", "foxglove", &imports, vec![image]),
    ])
}

/// Append a `CompressedImage` message: a PNG file, and the frame of its camera. `time` in nanoseconds since 1970.
pub fn put_png(time: u64, frame: &str, png: &[u8], out: &mut Vec<u8>) {
    timestamp(time, out);
    wire::bytes(2, png, out);
    wire::bytes(3, b"png", out);
    wire::bytes(4, frame.as_bytes(), out);
}

#[must_use]
pub fn log_descriptor() -> Vec<u8> {
    let levels = ["UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"];
    let levels = (0..).zip(levels).map(|(code, name)| (code, name.to_owned())).collect();
    let log = DescriptorProto {
        enum_type: vec![enumeration("Level", levels)],
        ..message(
            "Log",
            vec![
                timestamp_field(),
                typed_field("level", 2, Type::Enum, "foxglove.Log.Level"),
                field("message", 3, Type::String),
                field("name", 4, Type::String),
                field("file", 5, Type::String),
                field("line", 6, Type::Fixed32),
            ],
        )
    };
    let imports = ["google/protobuf/timestamp.proto"];
    encode_set(vec![timestamp_file(), file("foxglove/Log.proto", "foxglove", &imports, vec![log])])
}

pub(super) fn timestamp(nanoseconds: u64, out: &mut Vec<u8>) {
    wire::nested(1, out, |out| {
        wire::unsigned(1, nanoseconds / 1_000_000_000, out);
        wire::unsigned(2, nanoseconds % 1_000_000_000, out);
    });
}

/// Append one transform to a `FrameTransforms` message. `time` in nanoseconds since 1970.
pub fn put_transform(time: u64, parent: &str, child: &str, transform: &Transform, out: &mut Vec<u8>) {
    wire::nested(1, out, |out| {
        timestamp(time, out);
        wire::bytes(2, parent.as_bytes(), out);
        wire::bytes(3, child.as_bytes(), out);
        wire::nested(4, out, |out| put_doubles(&transform.position, out));
        wire::nested(5, out, |out| put_doubles(&transform.rotation, out));
    });
}

pub(super) fn put_doubles(values: &[f64], out: &mut Vec<u8>) {
    (1..).zip(values).for_each(|(number, value)| wire::double(number, *value, out));
}

/// Append a `Log` message. `time` in nanoseconds since 1970; `file` and `line` are the source of the row, if any.
pub fn put_log(time: u64, level: Level, text: &str, source: &str, file: &str, line: u32, out: &mut Vec<u8>) {
    timestamp(time, out);
    wire::unsigned(2, level as u64, out);
    wire::bytes(3, text.as_bytes(), out);
    wire::bytes(4, source.as_bytes(), out);
    wire::bytes(5, file.as_bytes(), out);
    wire::fixed32(6, line, out);
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Link {
    pub name: String,
    /// Name of the parent in the URDF; `world` for bodies that are fixed or move freely.
    pub parent: String,
}

/// The transforms of a `FrameTransforms` message, without their time stamps, up to the first malformed one.
#[must_use]
pub fn take_transforms(data: &[u8]) -> Vec<(Link, Transform)> {
    let transforms = wire::Fields(data).filter_map(|field| match field {
        (1, Value::Bytes(transform)) => Some(transform),
        _ => None,
    });
    transforms.map(take_transform).collect()
}

fn take_transform(data: &[u8]) -> (Link, Transform) {
    let mut link = Link { name: String::new(), parent: String::new() };
    let mut place = Transform::IDENTITY;
    for field in wire::Fields(data) {
        match field {
            (2, Value::Bytes(parent)) => link.parent = String::from_utf8_lossy(parent).into_owned(),
            (3, Value::Bytes(child)) => link.name = String::from_utf8_lossy(child).into_owned(),
            (4, Value::Bytes(position)) => take_doubles(position, &mut place.position),
            (5, Value::Bytes(rotation)) => take_doubles(rotation, &mut place.rotation),
            _ => {}
        }
    }
    (link, place)
}

/// Fields 1, 2, ... of a message whose fields are all doubles.
fn take_doubles(data: &[u8], out: &mut [f64]) {
    for field in wire::Fields(data) {
        let (number, Value::Bytes(bytes)) = field else { continue };
        let at = usize::try_from(number).ok().and_then(|number| number.checked_sub(1));
        if let (Some(slot), Ok(bytes)) = (at.and_then(|at| out.get_mut(at)), bytes.try_into()) {
            *slot = f64::from_le_bytes(bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use prost::Message as _;
    use prost_types::{FileDescriptorSet, Timestamp};

    #[test]
    fn descriptors_contain_all_named_types() {
        for (bytes, root) in [
            (frame_transforms_descriptor(), "FrameTransforms"),
            (log_descriptor(), "Log"),
            (compressed_image_descriptor(), "CompressedImage"),
        ] {
            let set = FileDescriptorSet::decode(bytes.as_slice()).unwrap();
            assert_eq!(set.file[0].name(), set.file[1].dependency[0]);
            assert!(set.file[1].message_type.iter().any(|message| message.name() == root));
        }
    }

    #[test]
    fn times_are_seconds_and_nanoseconds() {
        let mut out = Vec::new();
        timestamp(566_611_200_040_000_000, &mut out);
        let decoded = Timestamp::decode(&out[2..]).unwrap();
        assert_eq!(decoded, Timestamp { seconds: 566_611_200, nanos: 40_000_000 });
    }

    #[test]
    fn transforms_round_trip() {
        let place = Transform { position: [1.0, -2.0, 0.5], rotation: [0.0, 0.6, 0.0, 0.8] };
        let mut out = Vec::new();
        put_transform(1_000_000_002, "world", "arm", &place, &mut out);
        put_transform(1_000_000_002, "arm", "hand", &Transform::IDENTITY, &mut out);
        let link = |name: &str, parent: &str| Link { name: name.into(), parent: parent.into() };
        assert_eq!(
            take_transforms(&out),
            [(link("arm", "world"), place), (link("hand", "arm"), Transform::IDENTITY)]
        );
        assert!(take_transforms(&out[..out.len() - 1]).len() < 2, "an incomplete transform is dropped");
    }

    #[test]
    fn log_line_has_the_expected_bytes() {
        let mut out = Vec::new();
        put_log(1_000_000_002, Level::Error, "no", "Task", "", 7, &mut out);
        let expected: &[&[u8]] = &[
            &[0x0A, 0x04, 0x08, 0x01, 0x10, 0x02],
            &[0x10, 0x04],
            b"\x1A\x02no",
            b"\x22\x04Task",
            &[0x2A, 0x00],
            &[0x35, 7, 0, 0, 0],
        ];
        assert_eq!(out, expected.concat());
    }
}
