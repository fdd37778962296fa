//! The layout of byte images: which field stands at which byte, what a value is as text, and the version of
//! it all.
//!
//! Everything here walks the [`Schema`] trees that [`rcs_core::record!`] makes, so that a field that is added
//! to a buffer is described, compared and versioned without another line being written.

use std::fmt::Write as _;

use levels::ladder::LadderState;
use rcs_core::{
    digest::Digest,
    interface::{CommonMemory, ExternalInputs},
    plain::{FieldSchema, RecordSchema, Schema},
};

/// A field that is not made of other fields: where it stands in the image and what it holds.
#[derive(Clone, Debug)]
pub struct Leaf {
    /// Names from the outermost record inwards, joined by dots; array elements in brackets:
    /// `prim.poses[2].pose.tool[0]`.
    pub path: String,
    /// First byte in the image.
    pub offset: usize,
    /// What it holds.
    pub schema: &'static Schema,
}

impl Leaf {
    /// The bytes of the field in `image`; none if the image is too short.
    #[must_use]
    pub fn bytes<'a>(&self, image: &'a [u8]) -> &'a [u8] {
        image.get(self.offset..).and_then(|rest| rest.get(..self.schema.size())).unwrap_or_default()
    }
}

/// All leaves of a record in the order of the image.
#[must_use]
pub fn leaves(record: &'static RecordSchema) -> Vec<Leaf> {
    leaves_of(record.fields)
}

/// All leaves of consecutive fields.
#[must_use]
pub fn leaves_of(fields: &'static [FieldSchema]) -> Vec<Leaf> {
    let mut found = Vec::new();
    field_leaves(fields, "", 0, &mut found);
    found
}

fn field_leaves(fields: &'static [FieldSchema], prefix: &str, mut offset: usize, found: &mut Vec<Leaf>) {
    for field in fields {
        let path = if prefix.is_empty() { field.name.to_owned() } else { format!("{prefix}.{}", field.name) };
        schema_leaves(&field.schema, path, offset, found);
        offset += field.schema.size();
    }
}

fn schema_leaves(schema: &'static Schema, path: String, offset: usize, found: &mut Vec<Leaf>) {
    match schema {
        Schema::Record(record) => field_leaves(record.fields, &path, offset, found),
        // Bytes are read as one word: a frame on the line, not 64 numbers.
        Schema::Array(of, _) if **of == Schema::U8 => found.push(Leaf { path, offset, schema }),
        Schema::Array(of, count) => {
            for index in 0..*count {
                schema_leaves(of, format!("{path}[{index}]"), offset + index * of.size(), found);
            }
        }
        _ => found.push(Leaf { path, offset, schema }),
    }
}

/// The value of a leaf as people write it: numbers in decimal, names and variants as their text, bytes in
/// hexadecimal.
#[must_use]
pub fn value_text(schema: &Schema, bytes: &[u8]) -> String {
    match schema {
        Schema::U8 | Schema::U16 | Schema::U32 | Schema::U64 => unsigned(bytes).to_string(),
        Schema::I16 | Schema::I32 => signed(bytes).to_string(),
        Schema::F64 => f64::from_bits(unsigned(bytes)).to_string(),
        Schema::Bool => (unsigned(bytes) != 0).to_string(),
        Schema::Text(_) => format!("{:?}", text(bytes)),
        Schema::Enum(of) => {
            let code = unsigned(bytes);
            let variant = of.variants.iter().find(|(known, _)| u64::from(*known) == code);
            variant.map_or_else(|| format!("code {code}"), |(_, text)| format!("{text:?}"))
        }
        Schema::Array(..) | Schema::Record(_) => bytes.iter().map(|byte| format!("{byte:02X}")).collect(),
    }
}

/// An unsigned number of up to eight bytes, little-endian.
#[must_use]
pub fn unsigned(bytes: &[u8]) -> u64 {
    bytes.iter().take(8).rev().fold(0, |value, byte| value << 8 | u64::from(*byte))
}

/// A signed number of up to eight bytes, little-endian.
#[must_use]
pub fn signed(bytes: &[u8]) -> i64 {
    let unused = 64 - 8 * bytes.len().clamp(1, 8);
    (unsigned(bytes) << unused).cast_signed() >> unused
}

/// The text of a zero-filled name.
#[must_use]
pub fn text(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
    bytes.iter().take(end).copied().map(char::from).collect()
}

/// The first leaf in which two images of one record differ.
#[must_use]
pub fn first_difference<'a>(leaves: &'a [Leaf], was: &[u8], is: &[u8]) -> Option<&'a Leaf> {
    if was == is {
        return None;
    }
    leaves.iter().find(|leaf| leaf.bytes(was) != leaf.bytes(is))
}

/// The layout of a record for people and for the version: a line a leaf with its offset, size, kind and path,
/// and a line for each enum with its codes.
#[must_use]
pub fn describe(name: &str, record: &'static RecordSchema) -> String {
    let mut lines = format!("{name}: {}, {} bytes\n", record.name, record.size());
    let mut enums: Vec<&'static rcs_core::plain::EnumSchema> = Vec::new();
    for leaf in leaves(record) {
        let kind = kind_name(leaf.schema);
        // Writing to a String cannot fail.
        let _ = writeln!(lines, "{:6} {:4} {kind:12} {}", leaf.offset, leaf.schema.size(), leaf.path);
        if let Schema::Enum(of) = leaf.schema
            && !enums.contains(of)
        {
            enums.push(of);
        }
    }
    for of in enums {
        let codes: Vec<String> = of.variants.iter().map(|(code, text)| format!("{code} {text:?}")).collect();
        let _ = writeln!(lines, "enum {}: {}", of.name, codes.join(", "));
    }
    lines
}

fn kind_name(schema: &Schema) -> String {
    match schema {
        Schema::U8 => "u8".into(),
        Schema::U16 => "u16".into(),
        Schema::U32 => "u32".into(),
        Schema::U64 => "u64".into(),
        Schema::I16 => "i16".into(),
        Schema::I32 => "i32".into(),
        Schema::F64 => "f64".into(),
        Schema::Bool => "bool".into(),
        Schema::Text(_) => "text".into(),
        Schema::Enum(of) => of.name.into(),
        Schema::Array(of, count) => format!("{}[{count}]", kind_name(of)),
        Schema::Record(of) => of.name.into(),
    }
}

/// How images are written on `/replay`: see [`crate::delta`]. Logs of another format are refused as those of another layout.
const FORMAT: &str = "format 2: differences by field\n";

/// The layout of all images of a log: the text that goes into each log, and from which the version is made.
#[must_use]
pub fn description() -> String {
    [
        FORMAT.to_owned(),
        describe("external", ExternalInputs::RECORD),
        describe("memory", CommonMemory::RECORD),
        describe("state", LadderState::RECORD),
    ]
    .concat()
}

/// Version of what goes in and out of the ladder, without its states.
#[must_use]
pub fn interface_version() -> String {
    let mut digest = Digest::new();
    digest.add(describe("external", ExternalInputs::RECORD).as_bytes());
    digest.add(describe("memory", CommonMemory::RECORD).as_bytes());
    digest.to_string()
}

/// Version of the layout: a digest of [`description`], so that it changes when and only when an image means
/// something else.
#[must_use]
pub fn version() -> String {
    let mut digest = Digest::new();
    digest.add(description().as_bytes());
    digest.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rcs_core::{Plain, plain::Writer};

    fn image<T: Plain>(record: &T) -> Vec<u8> {
        let mut bytes = vec![0xA5; T::SIZE];
        record.encode(&mut Writer::new(&mut bytes));
        bytes
    }

    #[test]
    fn leaves_cover_every_byte_once() {
        for record in [ExternalInputs::RECORD, CommonMemory::RECORD, LadderState::RECORD] {
            let mut next = 0;
            for leaf in leaves(record) {
                assert_eq!(leaf.offset, next, "{}", leaf.path);
                next += leaf.schema.size();
            }
            assert_eq!(next, record.size());
        }
    }

    #[test]
    fn a_difference_names_its_field() {
        let was = CommonMemory::default();
        let mut is = was;
        is.prim.poses[2].pose.tool[1] = -7145;
        let leaves = leaves(CommonMemory::RECORD);
        let (was, is) = (image(&was), image(&is));
        let leaf = first_difference(&leaves, &was, &is).unwrap();
        assert_eq!(leaf.path, "prim.poses[2].pose.tool[1]");
        assert_eq!(value_text(leaf.schema, leaf.bytes(&was)), "0");
        assert_eq!(value_text(leaf.schema, leaf.bytes(&is)), "-7145");
        assert!(first_difference(&leaves, &was, &was).is_none());
    }

    #[test]
    fn values_read_as_people_write_them() {
        assert_eq!(value_text(&Schema::I16, &[0xFE, 0xFF]), "-2");
        assert_eq!(value_text(&Schema::U32, &[0, 0, 0, 0x80]), "2147483648");
        assert_eq!(value_text(&Schema::F64, &0.25_f64.to_le_bytes()), "0.25");
        assert_eq!(value_text(&Schema::Text(5), b"HOME\0"), "\"HOME\"");
        assert_eq!(value_text(&rcs_core::interface::Report::SCHEMA, &[3]), "\"error-state\"");
        assert_eq!(value_text(&rcs_core::interface::Report::SCHEMA, &[99]), "code 99");
    }
}
