//! Reflection: the fields of a byte image, each with its path, its bytes and its value as text.
//!
//! All functions traverse the [`Schema`] of `#[derive(Plain)]`, so a new field is shown, compared and versioned
//! without further code.
//!
//! | in the schema                              | leaves                                | as text           |
//! |--------------------------------------------|---------------------------------------|-------------------|
//! | number, flag, name, enum, array of bytes   | one                                   | `7`, `"HOME"`     |
//! | record, other array                        | those of its fields, of its elements  |                   |
//! | option of a value with one leaf            | one                                   | `none`, `7`       |
//! | other option                               | `x` for the flag, those of the value  | `none`, `some`    |
//! | union whose variants carry at most a leaf  | one                                   | `"candle" 7`      |
//! | other union                                | `x` for the variant, `x.variant` ...  | `"candle"`        |
//!
//! A leaf of a value that is absent from an image is `none`.
//!
//! ```
//! use rcs_core::{Plain, plain::to_bytes, reflect::{Value, leaves}};
//!
//! /// Where the table of the pedestal stands.
//! #[derive(Clone, Copy, Debug, PartialEq, Plain)]
//! pub struct Table {
//!     /// Angle, 0.1 degree.
//!     pub angle: i32,
//!     /// The object on it, if there is one.
//!     pub object: Option<u8>,
//! }
//! let image: [u8; 6] = to_bytes(&Table { angle: -2135, object: Some(7) });
//! let mut lines = Vec::new();
//! leaves(Table::STRUCT.fields, &mut |leaf| {
//!     let value = Value { schema: leaf.schema, bytes: &image[leaf.offset..][..leaf.size] };
//!     lines.push(format!("{} = {value} ({})", leaf.path, leaf.schema));
//! });
//! assert_eq!(lines, ["angle = -2135 (i32)", "object = 7 (option u8)"]);
//! ```

use core::fmt;

use crate::plain::{FieldSchema, Schema, UnionVariant};

/// Text of an absent value.
pub const NONE: &str = "none";

/// A field without subfields: its position in the image and its schema.
#[derive(Clone, Copy, Debug)]
pub struct Leaf<'a> {
    /// Names from outside inwards: `prim.poses[2].pose.tool[0]`. A union adds the name of its variant, an option none.
    pub path: fmt::Arguments<'a>,
    /// First byte in the image.
    pub offset: usize,
    /// Bytes in the image. For an option or a union with further leaves, only its first byte.
    pub size: usize,
    /// Schema of its value.
    pub schema: &'static Schema,
    /// The innermost enclosing option or union.
    pub within: Option<&'a Within<'a>>,
}

/// An option or union that encloses a value.
#[derive(Clone, Copy, Debug)]
pub struct Within<'a> {
    at: usize, // flag of the option, code of the variant
    code: u8,  // in images that contain the enclosed value
    outer: Option<&'a Self>,
}

impl Leaf<'_> {
    /// The option flags and variant codes that an image must have so that it contains this field: positions and values
    /// of the bytes.
    pub fn given(&self) -> impl Iterator<Item = (usize, u8)> {
        core::iter::successors(self.within, |within| within.outer).map(|within| (within.at, within.code))
    }
}

type Visit<'a> = dyn FnMut(Leaf<'_>) + 'a;

/// Visit all leaves of a record in the order of the image.
pub fn leaves(fields: &'static [FieldSchema], visit: &mut Visit<'_>) {
    walk_fields(fields, format_args!(""), 0, None, visit);
}

fn walk_fields(
    fields: &'static [FieldSchema],
    path: fmt::Arguments<'_>,
    mut offset: usize,
    within: Option<&Within<'_>>,
    visit: &mut Visit<'_>,
) {
    for field in fields {
        walk(&field.schema, format_args!("{path}{}", field.name), offset, within, visit);
        offset = offset.saturating_add(field.schema.size());
    }
}

fn walk(
    schema: &'static Schema,
    path: fmt::Arguments<'_>,
    offset: usize,
    within: Option<&Within<'_>>,
    visit: &mut Visit<'_>,
) {
    let (first, next) = (Leaf { path, offset, size: 1, schema, within }, offset.saturating_add(1));
    let carried = |code| Some(Within { at: offset, code, outer: within });
    match schema {
        Schema::Struct(record) => walk_fields(record.fields, format_args!("{path}."), offset, within, visit),
        _ if schema.is_leaf() => visit(Leaf { size: schema.size(), ..first }),
        Schema::Array(of, count) => {
            for index in 0..*count {
                let place = offset.saturating_add(index.saturating_mul(of.size()));
                walk(of, format_args!("{path}[{index}]"), place, within, visit);
            }
        }
        Schema::Option(of) => {
            visit(first);
            walk(of, path, next, carried(1).as_ref(), visit);
        }
        Schema::Union(of) => {
            visit(first);
            for UnionVariant { code, name, payload, .. } in of.variants {
                if let Some(payload) = payload {
                    walk(payload, format_args!("{path}.{name}"), next, carried(*code).as_ref(), visit);
                }
            }
        }
        _ => {}
    }
}

/// Visit all enums and unions in consecutive fields, outer ones first, once per occurrence.
pub fn definitions(fields: &'static [FieldSchema], visit: &mut dyn FnMut(Definition)) {
    fields.iter().for_each(|field| define(&field.schema, visit));
}

fn define(schema: &'static Schema, visit: &mut dyn FnMut(Definition)) {
    match schema {
        Schema::Enum(_) => visit(Definition(schema)),
        Schema::Union(of) => {
            visit(Definition(schema));
            let payloads = of.variants.iter().filter_map(|variant| variant.payload.as_ref());
            payloads.for_each(|payload| define(payload, visit));
        }
        Schema::Struct(of) => definitions(of.fields, visit),
        Schema::Array(of, _) | Schema::Option(of) => define(of, visit),
        _ => {}
    }
}

/// An enum or union as text: its codes, their texts and payloads.
#[derive(Clone, Copy, Debug)]
pub struct Definition(&'static Schema);

impl fmt::Display for Definition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let comma = |at: usize| if at == 0 { "" } else { ", " };
        match self.0 {
            Schema::Enum(of) => {
                write!(f, "enum {}: ", of.name)?;
                let mut variants = of.variants.iter().enumerate();
                variants.try_for_each(|(at, of)| write!(f, "{}{} {:?}", comma(at), of.code, of.text))
            }
            Schema::Union(of) => {
                write!(f, "union {}: ", of.name)?;
                of.variants.iter().enumerate().try_for_each(|(at, of)| {
                    write!(f, "{}{} {:?}", comma(at), of.code, of.text)?;
                    of.payload.as_ref().map_or(Ok(()), |payload| write!(f, " {payload}"))
                })
            }
            _ => Ok(()),
        }
    }
}

/// One word: `u16`, `option text 10`, the name of an enum.
impl fmt::Display for Schema {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::U8 => f.pad("u8"),
            Self::U16 => f.pad("u16"),
            Self::U32 => f.pad("u32"),
            Self::U64 => f.pad("u64"),
            Self::I16 => f.pad("i16"),
            Self::I32 => f.pad("i32"),
            Self::F64 => f.pad("f64"),
            Self::Bool => f.pad("bool"),
            Self::Text(length) => write!(f, "text {length}"),
            Self::Enum(of) => f.pad(of.name),
            Self::Array(of, count) => write!(f, "{of}[{count}]"),
            Self::Struct(of) => f.pad(of.name),
            Self::Option(of) => write!(f, "option {of}"),
            Self::Union(of) => f.pad(of.name),
        }
    }
}

impl Schema {
    /// True if the value is shown as one word.
    #[must_use]
    pub fn is_leaf(&self) -> bool {
        match self {
            Self::Struct(_) => false,
            Self::Array(of, _) => **of == Self::U8, // one word: a frame on the line, not 64 numbers
            Self::Option(of) => of.is_leaf(),
            Self::Union(of) => {
                of.variants.iter().filter_map(|variant| variant.payload.as_ref()).all(Self::is_leaf)
            }
            _ => true,
        }
    }
}

/// The value of a leaf as text: numbers in decimal, names and variants as their text, bytes in hexadecimal.
#[derive(Clone, Copy, Debug)]
pub struct Value<'a> {
    /// Schema of the value.
    pub schema: &'a Schema,
    /// The bytes of the leaf.
    pub bytes: &'a [u8],
}

impl fmt::Display for Value<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes = self.bytes;
        match self.schema {
            Schema::U8 | Schema::U16 | Schema::U32 | Schema::U64 => unsigned(bytes).fmt(f),
            Schema::I16 | Schema::I32 => signed(bytes).fmt(f),
            Schema::F64 => f64::from_bits(unsigned(bytes)).fmt(f),
            Schema::Bool => (unsigned(bytes) != 0).fmt(f),
            Schema::Text(_) => write!(f, "{:?}", text(bytes)),
            Schema::Enum(of) => match of.variants.iter().find(|of| u64::from(of.code) == unsigned(bytes)) {
                Some(variant) => write!(f, "{:?}", variant.text),
                None => write!(f, "code {}", unsigned(bytes)),
            },
            Schema::Option(schema) => match bytes.split_first() {
                Some((0, _)) | None => f.write_str(NONE),
                Some((_, [])) => f.write_str("some"),
                Some((_, bytes)) => Value { schema, bytes }.fmt(f),
            },
            Schema::Union(of) => {
                let (code, carried) =
                    bytes.split_first().map_or((0, bytes), |(code, carried)| (*code, carried));
                let Some(variant) = of.variants.iter().find(|variant| variant.code == code) else {
                    return write!(f, "code {code}");
                };
                write!(f, "{:?}", variant.text)?;
                match variant.payload.as_ref().and_then(|of| Some((of, carried.get(..of.size())?))) {
                    Some((schema, bytes)) => write!(f, " {}", Value { schema, bytes }),
                    None => Ok(()),
                }
            }
            Schema::Array(..) | Schema::Struct(_) => {
                bytes.iter().try_for_each(|byte| write!(f, "{byte:02X}"))
            }
        }
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
    let negative = bytes.get(..8).unwrap_or(bytes).last().is_some_and(|byte| byte & 0x80 != 0);
    let fill = if negative { u64::MAX } else { 0 };
    bytes.iter().take(8).rev().fold(fill, |value, byte| value << 8 | u64::from(*byte)).cast_signed()
}

/// The text of a zero-filled name; empty if it is invalid.
#[must_use]
pub fn text(bytes: &[u8]) -> &str {
    let name = bytes.split(|byte| *byte == 0).next().unwrap_or_default();
    core::str::from_utf8(name).unwrap_or_default()
}
