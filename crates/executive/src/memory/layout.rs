//! The layout of a run's services: their names, the records that the executive adds to those of the processes, and
//! their common version.

use std::sync::LazyLock;

use interfaces::{ExternalInputs, for_each_process};
use rcs_core::{Plain, digest::Digest, plain::Schema, tick::Tick};

use super::{
    cell::{CELL, CellView},
    history::{AllHeaders, HISTORY},
};

/// Epoch of a service: 1 for the first writer, the next number for a writer that replaces a killed one, because a
/// blackboard cannot be reopened for writing while a reader holds it. It is part of the service's name.
pub type Epoch = u32;

/// The executive's counts of a run, written once a tick. They depend on the machine and are not part of the digest.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Pulse {
    /// The tick that was run last.
    pub tick: Tick,
    /// Generation of the task data that it used.
    pub generation: u32,
    /// Number of slots of the 40 ms grid that were skipped so far.
    pub skipped: u64,
    /// Heap allocations of the controller since the start.
    pub allocations: u64,
    /// Time that the controller took for the tick, ns.
    pub controller_ns: u64,
    /// True if the run is over: nothing more will be written.
    pub over: bool,
}

/// The services of a run that are not outputs of a process.
pub(super) const OUTSIDE: &str = "outside";
pub(super) const EXECUTIVE: &str = "executive";

macro_rules! services {
    ($(
        #[doc = $doc:literal]
        $id:ident $text:literal {
            buffers: $field:ident, $outputs:ty;
            failure: $failure:ident;
            board: $board:literal;
            commander: $($commander:ident, $above:ident . $command:ident)?;
            reads: $reads:expr;
        }
    )+) => {
        /// The services of a run: for each its name and the schema of its slots.
        pub const SERVICES: &[(&str, Schema)] = &[
            $( (stringify!($field), <$outputs as Plain>::SCHEMA), )+
            (OUTSIDE, ExternalInputs::SCHEMA),
            (EXECUTIVE, Pulse::SCHEMA),
            (HISTORY, AllHeaders::SCHEMA),
            (CELL, CellView::SCHEMA),
        ];
    };
}
for_each_process!(services);

/// Version of the layout: a hash of the names and schemas of all services. Programs with different layouts never read
/// each other's bytes.
#[must_use]
pub fn layout_version() -> u32 {
    static VERSION: LazyLock<u32> = LazyLock::new(|| {
        let mut digest = Digest::new();
        for (service, schema) in SERVICES {
            add_text(&mut digest, service);
            add_schema(&mut digest, schema);
        }
        let hash = digest.value().to_le_bytes();
        u32::from_le_bytes([hash[0] ^ hash[4], hash[1] ^ hash[5], hash[2] ^ hash[6], hash[3] ^ hash[7]])
    });
    *VERSION
}

fn add_text(digest: &mut Digest, text: &str) {
    digest.add(text.as_bytes());
    digest.add(&[0]);
}

fn add_schema(digest: &mut Digest, schema: &Schema) {
    match schema {
        Schema::U8 => add_text(digest, "u8"),
        Schema::U16 => add_text(digest, "u16"),
        Schema::U32 => add_text(digest, "u32"),
        Schema::U64 => add_text(digest, "u64"),
        Schema::I16 => add_text(digest, "i16"),
        Schema::I32 => add_text(digest, "i32"),
        Schema::F64 => add_text(digest, "f64"),
        Schema::Bool => add_text(digest, "bool"),
        Schema::Text(length) => add_text(digest, &format!("text {length}")),
        Schema::Array(of, length) => {
            add_text(digest, &format!("array {length}"));
            add_schema(digest, of);
        }
        Schema::Enum(of) => {
            add_text(digest, of.name);
            for variant in of.variants {
                digest.add(&[variant.code]);
                add_text(digest, variant.text);
            }
        }
        Schema::Option(of) => {
            add_text(digest, "option");
            add_schema(digest, of);
        }
        Schema::Union(of) => {
            add_text(digest, of.name);
            for variant in of.variants {
                digest.add(&[variant.code]);
                add_text(digest, variant.text);
                match &variant.payload {
                    Some(payload) => add_schema(digest, payload),
                    None => add_text(digest, "nothing"),
                }
            }
            digest.add(&[0]);
        }
        Schema::Struct(of) => {
            add_text(digest, of.name);
            for field in of.fields {
                add_text(digest, field.name);
                add_schema(digest, &field.schema);
            }
            digest.add(&[0]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{SubtaskOutputs, TaskOutputs};
    use rcs_core::plain::{UnionSchema, UnionVariant};
    use std::collections::BTreeSet;

    #[test]
    fn the_layout_version_depends_on_every_word() {
        let version = |schema: &Schema| {
            let mut digest = Digest::new();
            add_schema(&mut digest, schema);
            digest.value()
        };
        assert_ne!(version(&Schema::Text(10)), version(&Schema::Text(12)));
        assert_ne!(version(&Schema::Array(&Schema::U8, 3)), version(&Schema::Array(&Schema::I16, 3)));
        assert_ne!(version(&TaskOutputs::SCHEMA), version(&SubtaskOutputs::SCHEMA));
        assert_ne!(version(&Schema::Option(&Schema::U8)), version(&Schema::U8));
        assert_ne!(version(&Schema::Option(&Schema::U8)), version(&Schema::Option(&Schema::Bool)));
        const fn carried(text: &'static str, payload: Option<Schema>) -> UnionVariant {
            UnionVariant { code: 0, text, payload }
        }
        static UNIONS: [UnionSchema; 4] = [
            UnionSchema::new("Goal", &[carried("at", None)]),
            UnionSchema::new("Goal", &[carried("at", Some(Schema::U8))]),
            UnionSchema::new("Goal", &[carried("at", Some(Schema::Bool))]),
            UnionSchema::new("Goal", &[carried("in", Some(Schema::Bool))]),
        ];
        let versions: BTreeSet<_> = UNIONS.iter().map(|of| version(&Schema::Union(of))).collect();
        assert_eq!(versions.len(), UNIONS.len());
        assert_eq!(layout_version(), layout_version());
    }
}
