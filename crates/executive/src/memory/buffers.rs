//! The buffers in shared memory, service by service.
//!
//! Each process has a service with one entry, its output buffers as a byte image. Two more services hold what came from outside and what
//! the executive says. iceoryx2 hands an entry over whole, so all buffers that a reader finds in it are of one tick.

use std::fmt::Debug;

use iceoryx2::{
    node::Node,
    port::{reader::EntryHandle, writer::EntryHandleMut},
    prelude::ipc,
};
use rcs_core::{
    Plain,
    digest::Digest,
    for_each_process,
    interface::{CommonMemory, ExternalInputs},
    plain::{DecodeError, Schema, from_bytes, to_bytes},
    tick::Tick,
};
use std::marker::PhantomData;

use super::{error::SharedMemoryError, runs};

/// Epoch of a service: 1 for the first writer, the next number for a writer that takes over from a killed one, because a blackboard
/// cannot be reopened for writing while a reader holds it. Part of the service's name.
pub type Epoch = u32;

/// What the executive says about a run, once a tick. Holds counts of this machine: not part of the digest.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Pulse {
    /// The tick that was run last.
    pub tick: Tick,
    /// Generation of the task data that it used.
    pub generation: u32,
    /// Slots of the 40 ms grid that were skipped so far.
    pub skipped: u64,
    /// Heap allocations of the controller since the start.
    pub allocations: u64,
    /// Nanoseconds that the controller took for the tick.
    pub controller_ns: u64,
    /// The run is over: nothing will be written any more.
    pub over: bool,
}

/// What came from outside for a tick.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Outside {
    /// The tick that reads it.
    pub tick: Tick,
    /// All that was read.
    pub inputs: ExternalInputs,
}

/// Key of the one entry of a service.
const ENTRY: u32 = 0;

/// The writer's end of a service whose entry has `N` bytes.
pub struct ServiceWriter<const N: usize, T> {
    entry: EntryHandleMut<ipc::Service, u32, [u8; N]>,
    holds: PhantomData<T>,
}

impl<const N: usize, T: Plain> ServiceWriter<N, T> {
    /// Create the service and its entry, zeroed.
    pub(super) fn create(
        node: &Node<ipc::Service>,
        service: &'static str,
        epoch: Epoch,
    ) -> Result<Self, SharedMemoryError> {
        let failed = |what: &dyn Debug| SharedMemoryError::service(service, what);
        let name = runs::service_name(service, epoch)?;
        let factory = node
            .service_builder(&name)
            .blackboard_creator::<u32>()
            .max_readers(runs::MAX_READERS)
            .max_nodes(runs::MAX_READERS + 1)
            .add::<[u8; N]>(ENTRY, to_bytes(&T::ZERO))
            .create()
            .map_err(|error| failed(&error))?;
        let port = factory.writer_builder().create().map_err(|error| failed(&error))?;
        let entry = port.entry(&ENTRY).map_err(|error| failed(&error))?;
        Ok(Self { entry, holds: PhantomData })
    }

    /// Write the entry. Does not allocate.
    pub fn write(&self, value: &T) {
        self.entry.update_with_copy(to_bytes(value));
    }
}

/// A reader's end of a service.
pub struct ServiceReader<const N: usize, T> {
    entry: EntryHandle<ipc::Service, u32, [u8; N]>,
    holds: PhantomData<T>,
}

impl<const N: usize, T: Plain> ServiceReader<N, T> {
    /// Open the service.
    pub(super) fn open(
        node: &Node<ipc::Service>,
        service: &'static str,
        epoch: Epoch,
    ) -> Result<Self, SharedMemoryError> {
        let failed = |what: &dyn Debug| SharedMemoryError::service(service, what);
        let name = runs::service_name(service, epoch)?;
        let factory =
            node.service_builder(&name).blackboard_opener::<u32>().open().map_err(|error| failed(&error))?;
        let port = factory.reader_builder().create().map_err(|error| failed(&error))?;
        let entry = port.entry(&ENTRY).map_err(|error| failed(&error))?;
        Ok(Self { entry, holds: PhantomData })
    }

    /// The latest value.
    pub fn read(&self) -> Result<T, DecodeError> {
        let image: [u8; N] = *self.entry.get();
        from_bytes(&image)
    }
}

/// The services of a run that no process writes.
const OUTSIDE: &str = "outside";
const EXECUTIVE: &str = "executive";

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
        /// The services of a run: for each its name and the schema of its entry.
        pub const SERVICES: &[(&str, Schema)] = &[
            $( (stringify!($field), <$outputs as Plain>::SCHEMA), )+
            (OUTSIDE, Outside::SCHEMA),
            (EXECUTIVE, Pulse::SCHEMA),
        ];

        /// The writer's ends of all services.
        pub struct Writers {
            $( $field: ServiceWriter<{ <$outputs as Plain>::SIZE }, $outputs>, )+
            outside: ServiceWriter<{ Outside::SIZE }, Outside>,
            /// What the executive says.
            pub executive: ServiceWriter<{ Pulse::SIZE }, Pulse>,
        }

        impl Writers {
            /// Create all services.
            ///
            /// # Errors
            /// What iceoryx2 says.
            pub(super) fn create(node: &Node<ipc::Service>, epoch: Epoch) -> Result<Self, SharedMemoryError> {
                Ok(Self {
                    $( $field: ServiceWriter::create(node, stringify!($field), epoch)?, )+
                    outside: ServiceWriter::create(node, OUTSIDE, epoch)?,
                    executive: ServiceWriter::create(node, EXECUTIVE, epoch)?,
                })
            }

            /// Write a tick: what came in, what the processes wrote, and the pulse, in this order. Does not allocate.
            pub fn write(&self, inputs: &ExternalInputs, memory: &CommonMemory, pulse: &Pulse) {
                self.outside.write(&Outside { tick: pulse.tick, inputs: *inputs });
                $( self.$field.write(&memory.$field); )+
                self.executive.write(pulse);
            }
        }

        /// A reader's ends of all services.
        pub struct Readers {
            $( $field: ServiceReader<{ <$outputs as Plain>::SIZE }, $outputs>, )+
            /// What came from outside.
            pub outside: ServiceReader<{ Outside::SIZE }, Outside>,
            /// What the executive says.
            pub executive: ServiceReader<{ Pulse::SIZE }, Pulse>,
        }

        impl Readers {
            /// Open all services.
            ///
            /// # Errors
            /// What iceoryx2 says.
            pub(super) fn open(node: &Node<ipc::Service>, epoch: Epoch) -> Result<Self, SharedMemoryError> {
                Ok(Self {
                    $( $field: ServiceReader::open(node, stringify!($field), epoch)?, )+
                    outside: ServiceReader::open(node, OUTSIDE, epoch)?,
                    executive: ServiceReader::open(node, EXECUTIVE, epoch)?,
                })
            }

            /// The outputs of all processes, each whole, maybe of different ticks.
            ///
            /// # Errors
            /// If there are bytes that no process writes.
            pub fn processes(&self) -> Result<CommonMemory, DecodeError> {
                Ok(CommonMemory { $( $field: self.$field.read()?, )+ })
            }
        }
    };
}
for_each_process!(services);

/// Version of the layout: a hash of the names and schemas of all services. Programs that were built with different layouts never read
/// each other's bytes.
#[must_use]
pub fn layout_version() -> u32 {
    let mut digest = Digest::new();
    for (service, schema) in SERVICES {
        add_text(&mut digest, service);
        add_schema(&mut digest, schema);
    }
    let hash = digest.value().to_le_bytes();
    u32::from_le_bytes([hash[0] ^ hash[4], hash[1] ^ hash[5], hash[2] ^ hash[6], hash[3] ^ hash[7]])
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
    use rcs_core::{
        interface::{SubtaskOutputs, TaskOutputs},
        plain::{UnionSchema, UnionVariant},
    };
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
            UnionSchema { name: "Goal", variants: &[carried("at", None)] },
            UnionSchema { name: "Goal", variants: &[carried("at", Some(Schema::U8))] },
            UnionSchema { name: "Goal", variants: &[carried("at", Some(Schema::Bool))] },
            UnionSchema { name: "Goal", variants: &[carried("in", Some(Schema::Bool))] },
        ];
        let versions: BTreeSet<_> = UNIONS.iter().map(|of| version(&Schema::Union(of))).collect();
        assert_eq!(versions.len(), UNIONS.len());
        assert_eq!(layout_version(), layout_version());
    }
}
