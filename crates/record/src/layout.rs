//! The layout of byte images: position of each field, text of a value, version. A [`Leaf`] is one field that is kept.

use std::{fmt::Write as _, sync::LazyLock};

use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::LadderState;
use rcs_core::{
    digest::Digest,
    plain::{FieldSchema, Schema, StructSchema},
    reflect::{self, Value},
};

#[derive(Clone, Debug)]
pub struct Leaf {
    /// Names from the outermost record inwards: `prim.poses[2].pose.tool[0]`.
    pub path: String,
    pub offset: usize, // in the image
    /// Number of bytes in the image. For an option or a union with other leaves, only the first byte.
    pub size: usize,
    pub schema: &'static Schema,
    /// Bytes that must have this value in an image with the leaf: flags of options, codes of variants.
    pub given: Vec<(usize, u8)>,
}

impl Leaf {
    /// The bytes of the field in `image`; empty if the image is too short.
    #[must_use]
    pub fn bytes<'a>(&self, image: &'a [u8]) -> &'a [u8] {
        image.get(self.offset..).and_then(|rest| rest.get(..self.size)).unwrap_or_default()
    }

    /// True if `image` contains the value to which the field belongs.
    #[must_use]
    pub fn is_in(&self, image: &[u8]) -> bool {
        self.given.iter().all(|(at, byte)| image.get(*at) == Some(byte))
    }

    #[must_use]
    pub fn text(&self, image: &[u8]) -> String {
        let value = Value { schema: self.schema, bytes: self.bytes(image) };
        if self.is_in(image) { value.to_string() } else { reflect::NONE.to_owned() }
    }

    /// True for a record number of the task data. Added data change the numbers of later records but not their meaning.
    /// So runs with different task data are compared without these fields.
    #[must_use]
    pub fn is_record_number(&self) -> bool {
        let number = match self.schema {
            Schema::Option(of) => **of == Schema::U32,
            schema => *schema == Schema::U32,
        };
        let name = self.path.rsplit('.').next().unwrap_or_default();
        number && RECORD_NUMBERS.contains(&name)
    }

    /// True if the values of the field in two images differ.
    #[must_use]
    pub fn differs(&self, was: &[u8], is: &[u8]) -> bool {
        self.bytes(was) != self.bytes(is) && (self.is_in(was) || self.is_in(is))
    }
}

const RECORD_NUMBERS: [&str; 14] = [
    "approach",
    "array",
    "between",
    "depart",
    "movetable",
    "object_grips",
    "object_parameters",
    "object_vision",
    "parameters",
    "pose",
    "record",
    "reference_pose",
    "stop",
    "trajectory_parameters",
];

#[must_use]
pub fn leaves(record: &'static StructSchema) -> Vec<Leaf> {
    leaves_of(record.fields)
}

#[must_use]
pub fn leaves_of(fields: &'static [FieldSchema]) -> Vec<Leaf> {
    let mut found = Vec::new();
    reflect::leaves(fields, &mut |leaf| {
        let given = leaf.given().collect();
        let reflect::Leaf { path, offset, size, schema, .. } = leaf;
        found.push(Leaf { path: path.to_string(), offset, size, schema, given });
    });
    found
}

/// A range of an image that changes as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece {
    pub offset: usize,
    pub size: usize,
    /// True for a number of at most eight bytes, which changes by a difference.
    pub number: bool,
}

/// The pieces of a record. The payloads of a union's variants share the same bytes, so they are one piece.
#[must_use]
pub fn pieces(record: &'static StructSchema) -> Vec<Piece> {
    let mut found = Vec::new();
    record_pieces(record, 0, &mut found);
    found
}

fn record_pieces(record: &StructSchema, mut offset: usize, found: &mut Vec<Piece>) {
    for field in record.fields {
        schema_pieces(&field.schema, offset, found);
        offset += field.schema.size();
    }
}

fn schema_pieces(schema: &Schema, offset: usize, found: &mut Vec<Piece>) {
    let mut piece = |offset, size, number| found.push(Piece { offset, size, number });
    match schema {
        Schema::Struct(record) => record_pieces(record, offset, found),
        Schema::Text(_) | Schema::Array(Schema::U8, _) => piece(offset, schema.size(), false),
        Schema::Array(of, count) => {
            (0..*count).for_each(|index| schema_pieces(of, offset + index * of.size(), found));
        }
        Schema::Option(of) => {
            piece(offset, 1, true);
            schema_pieces(of, offset + 1, found);
        }
        Schema::Union(of) => {
            piece(offset, 1, true);
            match of.payload_size() {
                0 => {}
                size => piece(offset + 1, size, size <= 8),
            }
        }
        _ => piece(offset, schema.size(), true),
    }
}

/// The first leaf in which two images of one record differ.
#[must_use]
pub fn first_difference<'a>(leaves: &'a [Leaf], was: &[u8], is: &[u8]) -> Option<&'a Leaf> {
    if was == is {
        return None;
    }
    let differ = |leaf: &&Leaf| leaf.differs(was, is);
    // Bytes outside all values differ only if an image was not encoded.
    leaves.iter().find(differ).or_else(|| leaves.iter().find(|leaf| leaf.bytes(was) != leaf.bytes(is)))
}

/// The layout of a record for readers and for the version: one line per leaf, enum and union.
#[must_use]
pub fn describe(name: &str, record: &'static StructSchema) -> String {
    let mut lines = format!("{name}: {}, {} bytes\n", record.name, record.size());
    for leaf in leaves(record) {
        let kind = leaf.schema.to_string();
        let _ = writeln!(lines, "{:6} {:4} {kind:12} {}", leaf.offset, leaf.size, leaf.path);
    }
    let mut definitions: Vec<String> = Vec::new();
    reflect::definitions(record.fields, &mut |definition| {
        let line = format!("{definition}\n");
        if !definitions.contains(&line) {
            definitions.push(line);
        }
    });
    lines + &definitions.concat()
}

/// Format of the images on `/replay` ([`crate::delta`]). Logs of another format are refused.
const FORMAT: &str = "format 2: differences by field\n";

/// The layout of all images of a log: a text in each log, from which the version is computed.
#[must_use]
pub fn description() -> &'static str {
    static DESCRIPTION: LazyLock<String> = LazyLock::new(|| {
        [
            FORMAT.to_owned(),
            describe("external", ExternalInputs::STRUCT),
            describe("memory", CommonMemory::STRUCT),
            describe("state", LadderState::STRUCT),
        ]
        .concat()
    });
    &DESCRIPTION
}

/// Version of the inputs and outputs of the ladder, without its states.
#[must_use]
pub fn interface_version() -> String {
    let mut digest = Digest::new();
    digest.add(describe("external", ExternalInputs::STRUCT).as_bytes());
    digest.add(describe("memory", CommonMemory::STRUCT).as_bytes());
    digest.to_string()
}

/// Version of the layout: a digest of [`description`], which changes if, and only if, the meaning of an image changes.
#[must_use]
pub fn version() -> String {
    let mut digest = Digest::new();
    digest.add(description().as_bytes());
    digest.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rcs_core::{Plain, name::Name10, plain::Writer};

    #[derive(Clone, Copy, Debug, PartialEq, Plain)]
    struct Place {
        x: i16,
        name: Name10,
    }

    #[derive(Clone, Copy, Debug, PartialEq, Plain)]
    enum Phase {
        Rest,
        #[text = "MOVE-TO"]
        Move(bool),
    }

    #[derive(Clone, Copy, Debug, PartialEq, Plain)]
    enum Goal {
        Nowhere,
        #[text = "at a place"]
        At(Place),
        Kind(u32),
    }

    #[derive(Clone, Copy, Debug, PartialEq, Plain)]
    struct Order {
        number: Option<u16>,
        phase: Phase,
        from: Option<Place>,
        to: Goal,
    }

    fn image<T: Plain>(record: &T) -> Vec<u8> {
        let mut bytes = vec![0xA5; T::SIZE];
        record.encode(&mut Writer::new(&mut bytes));
        bytes
    }

    fn value_text(schema: &Schema, bytes: &[u8]) -> String {
        Value { schema, bytes }.to_string()
    }

    fn texts<T: Plain>(record: &'static StructSchema, value: &T) -> Vec<(String, String)> {
        let image = image(value);
        leaves(record).into_iter().map(|leaf| (leaf.path.clone(), leaf.text(&image))).collect()
    }

    fn ordered() -> Order {
        let place = |x, name| Place { x, name: Name10::new(name).unwrap() };
        Order {
            number: Some(7),
            phase: Phase::Move(true),
            from: Some(place(-2, "HOME")),
            to: Goal::At(place(3, "UNIT")),
        }
    }

    #[test]
    fn every_record_number_name_matches_a_field() {
        let all: Vec<Leaf> =
            [CommonMemory::STRUCT, LadderState::STRUCT].into_iter().flat_map(leaves).collect();
        for name in RECORD_NUMBERS {
            let is_meant = |leaf: &&Leaf| leaf.is_record_number() && leaf.path.ends_with(name);
            assert!(all.iter().any(|leaf| is_meant(&leaf)), "{name}");
        }
        assert!(all.iter().any(|leaf| leaf.path == "emove.prim.number" && !leaf.is_record_number()));
    }

    #[test]
    fn pieces_cover_every_byte_once() {
        for record in [ExternalInputs::STRUCT, CommonMemory::STRUCT, LadderState::STRUCT, Order::STRUCT] {
            let mut next = 0;
            for piece in pieces(record) {
                assert_eq!(piece.offset, next);
                next += piece.size;
            }
            assert_eq!(next, record.size());
        }
    }

    #[test]
    fn leaves_cover_every_byte_and_have_unique_paths() {
        for record in [ExternalInputs::STRUCT, CommonMemory::STRUCT, LadderState::STRUCT, Order::STRUCT] {
            let (leaves, mut covered) = (leaves(record), vec![false; record.size()]);
            for (at, leaf) in leaves.iter().enumerate() {
                covered[leaf.offset..leaf.offset + leaf.size].fill(true);
                assert!(leaves[..at].iter().all(|other| other.path != leaf.path), "{}", leaf.path);
            }
            assert!(covered.iter().all(|byte| *byte));
        }
    }

    #[test]
    fn difference_names_its_field() {
        let was = CommonMemory::default();
        let mut is = was;
        is.prim.poses[2].pose.tool[1] = -7145;
        let leaves = leaves(CommonMemory::STRUCT);
        let (was, is) = (image(&was), image(&is));
        let leaf = first_difference(&leaves, &was, &is).unwrap();
        assert_eq!(leaf.path, "prim.poses[2].pose.tool[1]");
        assert_eq!((leaf.text(&was).as_str(), leaf.text(&is).as_str()), ("0", "-7145"));
        assert!(first_difference(&leaves, &was, &was).is_none());
    }

    #[test]
    fn values_have_readable_text() {
        assert_eq!(value_text(&Schema::I16, &[0xFE, 0xFF]), "-2");
        assert_eq!(value_text(&Schema::U32, &[0, 0, 0, 0x80]), "2147483648");
        assert_eq!(value_text(&Schema::F64, &0.25_f64.to_le_bytes()), "0.25");
        assert_eq!(value_text(&Schema::Text(5), b"HOME\0"), "\"HOME\"");
        assert_eq!(value_text(&interfaces::StatusReport::SCHEMA, &[3]), "\"error-state\"");
        assert_eq!(value_text(&interfaces::StatusReport::SCHEMA, &[99]), "code 99");
        let number = Schema::Option(&Schema::U16);
        assert_eq!([[0, 0, 0], [1, 7, 1]].map(|bytes| value_text(&number, &bytes)), ["none", "263"]);
        let phases = [[0, 0], [1, 0], [9, 0]].map(|bytes| value_text(&Phase::SCHEMA, &bytes));
        assert_eq!(phases, ["\"rest\"", "\"MOVE-TO\" false", "code 9"]);
    }

    #[test]
    fn absent_value_is_none() {
        let told = |order: &Order| {
            let found = texts(Order::STRUCT, order);
            found.iter().map(|(path, text)| format!("{path} {text}")).collect::<Vec<_>>()
        };
        let expected = [
            "number 7",
            "phase \"MOVE-TO\" true",
            "from some",
            "from.x -2",
            "from.name \"HOME\"",
            "to \"at a place\"",
            "to.at_a_place.x 3",
            "to.at_a_place.name \"UNIT\"",
            "to.kind_2 none",
        ];
        assert_eq!(told(&ordered()), expected);
        let expected = [
            "number none",
            "phase \"rest\"",
            "from none",
            "from.x none",
            "from.name none",
            "to \"kind\"",
            "to.at_a_place.x none",
            "to.at_a_place.name none",
            "to.kind_2 1027",
        ];
        assert_eq!(told(&Order { to: Goal::Kind(1027), ..Order::default() }), expected);
    }

    #[test]
    fn leaves_have_the_offsets_of_their_bytes() {
        let expected = [
            1, 7, 0, // number
            1, 1, // phase
            1, 0xFE, 0xFF, b'H', b'O', b'M', b'E', 0, 0, 0, 0, 0, 0, // from
            1, 3, 0, b'U', b'N', b'I', b'T', 0, 0, 0, 0, 0, 0, // to
        ];
        assert_eq!(image(&ordered()), expected);
        let places: Vec<_> = leaves(Order::STRUCT).iter().map(|leaf| (leaf.offset, leaf.size)).collect();
        assert_eq!(
            places,
            [(0, 3), (3, 2), (5, 1), (6, 2), (8, 10), (18, 1), (19, 2), (21, 10), (19, 4)],
            "the values of the variants use the same bytes"
        );
    }

    /// Bytes of an inactive variant are not a difference.
    #[test]
    fn difference_is_in_the_active_variant() {
        let (was, leaves) = (Order { to: Goal::Kind(1), ..Order::default() }, leaves(Order::STRUCT));
        let first = |is: &Order| {
            let (was, is) = (image(&was), image(is));
            let leaf = first_difference(&leaves, &was, &is).unwrap();
            (leaf.path.clone(), leaf.text(&was), leaf.text(&is))
        };
        let of = |path: &str, was: &str, is: &str| (path.to_owned(), was.to_owned(), is.to_owned());
        assert_eq!(first(&Order { to: Goal::Kind(2), ..was }), of("to.kind_2", "1", "2"));
        assert_eq!(first(&Order { to: Goal::Nowhere, ..was }), of("to", "\"kind\"", "\"nowhere\""));
        assert_eq!(first(&Order { number: Some(0), ..was }), of("number", "none", "0"));
        assert_eq!(first(&Order { from: Some(Place::default()), ..was }), of("from", "none", "some"));
    }

    #[test]
    fn description_lists_the_payloads_of_a_union() {
        let text = describe("order", Order::STRUCT);
        let expected = "\
order: Order, 31 bytes
     0    3 option u16   number
     3    2 Phase        phase
     5    1 option Place from
     6    2 i16          from.x
     8   10 text 10      from.name
    18    1 Goal         to
    19    2 i16          to.at_a_place.x
    21   10 text 10      to.at_a_place.name
    19    4 u32          to.kind_2
union Phase: 0 \"rest\", 1 \"MOVE-TO\" bool
union Goal: 0 \"nowhere\", 1 \"at a place\" Place, 2 \"kind\" u32
";
        assert_eq!(text, expected);
    }
}
