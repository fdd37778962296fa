//! The layout of a run's services: their names, the executive's own records, and their common version.

use std::sync::LazyLock;

use interfaces::{ExternalInputs, Header, PROCESS_COUNT, for_each_process};
use rcs_core::{Plain, digest::Digest, plain::FieldSchema, reflect, tick::Tick};

use super::{
    cell::{CELL, CellView},
    field::{FIELD, FieldView},
};

/// Epoch of a service, part of its name: the next number for a writer that replaces a killed one, because a blackboard
/// cannot be reopened for writing while a reader holds it.
pub type Epoch = u32;

/// The executive's counts of a run, written once per tick. They depend on the machine and are not in the digest.
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
pub(super) const HISTORY: &str = "history";

/// The headers of all processes, in the order of [`ProcessId`](interfaces::ProcessId).
pub(super) type AllHeaders = [Header; PROCESS_COUNT];

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
        pub const SERVICES: &[FieldSchema] = &[
            $( FieldSchema { name: stringify!($field), schema: <$outputs as Plain>::SCHEMA }, )+
            FieldSchema { name: OUTSIDE, schema: ExternalInputs::SCHEMA },
            FieldSchema { name: EXECUTIVE, schema: Pulse::SCHEMA },
            FieldSchema { name: HISTORY, schema: AllHeaders::SCHEMA },
            FieldSchema { name: CELL, schema: CellView::SCHEMA },
            FieldSchema { name: FIELD, schema: FieldView::SCHEMA },
        ];
    };
}
for_each_process!(services);

/// A hash of the names and schemas of all services. Programs with different layouts never read each other's bytes.
#[must_use]
pub fn layout_version() -> u32 {
    static VERSION: LazyLock<u32> = LazyLock::new(|| {
        let hash = fingerprint(SERVICES).to_le_bytes();
        u32::from_le_bytes([hash[0] ^ hash[4], hash[1] ^ hash[5], hash[2] ^ hash[6], hash[3] ^ hash[7]])
    });
    *VERSION
}

/// A hash of the kind and place of each field, and of the codes of enums and unions.
fn fingerprint(fields: &'static [FieldSchema]) -> u64 {
    let mut digest = Digest::new();
    reflect::leaves(fields, &mut |leaf| {
        digest.add(format!("{} {} {}", leaf.path, leaf.offset, leaf.schema).as_bytes());
    });
    reflect::definitions(fields, &mut |definition| digest.add(definition.to_string().as_bytes()));
    digest.value()
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{SubtaskOutputs, TaskOutputs};
    use rcs_core::plain::{Schema, UnionSchema, UnionVariant};
    use std::collections::BTreeSet;

    #[test]
    fn the_layout_version_depends_on_every_word() {
        const fn of(schema: Schema) -> [FieldSchema; 1] {
            [FieldSchema { name: "service", schema }]
        }
        const fn goal(variants: &'static [UnionVariant]) -> UnionSchema {
            UnionSchema::new("Goal", variants)
        }
        const fn carried(text: &'static str, payload: Option<Schema>) -> UnionVariant {
            UnionVariant { code: 0, text, name: text, payload }
        }
        static SCHEMAS: &[[FieldSchema; 1]] = &[
            of(Schema::Text(10)),
            of(Schema::Text(12)),
            of(Schema::Array(&Schema::U8, 3)),
            of(Schema::Array(&Schema::I16, 3)),
            of(TaskOutputs::SCHEMA),
            of(SubtaskOutputs::SCHEMA),
            of(Schema::U8),
            of(Schema::Option(&Schema::U8)),
            of(Schema::Option(&Schema::Bool)),
            of(Schema::Union(&goal(&[carried("at", None)]))),
            of(Schema::Union(&goal(&[carried("at", Some(Schema::U8))]))),
            of(Schema::Union(&goal(&[carried("at", Some(Schema::Bool))]))),
            of(Schema::Union(&goal(&[carried("in", Some(Schema::Bool))]))),
        ];
        let versions: BTreeSet<_> = SCHEMAS.iter().map(|fields| fingerprint(fields)).collect();
        assert_eq!(versions.len(), SCHEMAS.len());
        assert_eq!(layout_version(), layout_version());
    }
}
