//! The buffers in shared memory, service by service.
//!
//! The macro `services!` turns the list at the end of this file into one pair of structures a service: the
//! writer's ends of its buffers and the readers' ends. A buffer travels as header and byte image; all buffers
//! of a service that bear the same stamp belong together, and a reader that finds different stamps looks
//! again.

use std::{fmt::Debug, marker::PhantomData};

use iceoryx2::{
    node::Node,
    port::{reader::EntryHandle, writer::EntryHandleMut},
    prelude::ipc,
};
use rcs_core::{
    Plain,
    digest::Digest,
    interface::{
        ChangingPose, DataBaseCommand, DataBaseStatus, EmoveOutputs, GripOutputs, Header, HwsCommand,
        JawsOutputs, OutsidePedestal, PedestalOutputs, PrimOutputs, QuickChangeOutputs, SubtaskOutputs,
        T3iOutputs, TableOutputs, TaskOutputs,
        device::{
            DeviceInputs, GripValves, JawValves, LinkBytes, MotorCommand, QuickChangeValves, VisionRequest,
        },
        emove::{Dormancy, EMOVE_POSES, EmoveCommand, EmoveStatus},
        grip::{GripCommand, GripStatus},
        hws::{HwsStatus, TASK_POSES},
        jaws::{JawsCommand, JawsStatus},
        pedestal::{PedestalCommand, PedestalStatus, TableCommand, TableStatus},
        prim::{PRIM_POSES, PrimCommand, PrimStatus},
        quick_change::{QuickChangeCommand, QuickChangeStatus},
        subtask::{SUBTASK_POSES, SubtaskCommand, SubtaskStatus},
        t3i::{T3iCommand, T3iStatus},
    },
    plain::{DecodeError, Reader, Schema, Writer},
    tick::Tick,
};

use super::runs::SharedMemoryError;

/// Epoch of a service: 1 for the first writer, the next number for a writer that takes over from a killed
/// one, because a blackboard cannot be reopened for writing while a reader holds it. Part of the service's
/// name.
pub type Epoch = u32;

/// What the executive says about a run, once a tick. Holds counts of this machine: not part of the
/// digest.
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

/// Buffers of the workstation controller.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct HwscOutputs {
    /// Stamp: the tick that reads the buffers.
    pub header: Header,
    /// To Task.
    pub command: HwsCommand,
}

/// Buffers of the Data System.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct DataBaseOutputs {
    /// Stamp: the tick that reads the buffers.
    pub header: Header,
    /// To Task.
    pub status: DataBaseStatus,
}

/// Buffers of an Active Pedestal that is a system of its own.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct OutsidePedestalOutputs {
    /// Stamp: the tick that reads the buffers.
    pub header: Header,
    /// For the buffers of the pedestal's processes.
    pub sent: OutsidePedestal,
}

/// Buffers of the devices.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct DevicesOutputs {
    /// Stamp: the tick that reads the buffers.
    pub header: Header,
    /// To the processes that own the devices.
    pub inputs: DeviceInputs,
}

/// Buffers of the executive.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct ExecutiveOutputs {
    /// Stamp.
    pub header: Header,
    /// To everybody.
    pub pulse: Pulse,
}

/// Bytes of a buffer in shared memory.
const fn image_size<T: Plain>() -> usize {
    Header::SIZE + T::SIZE
}

/// A buffer as it stands in shared memory.
fn image<const N: usize, T: Plain>(header: &Header, value: &T) -> [u8; N] {
    let mut bytes = [0; N];
    let mut w = Writer::new(&mut bytes);
    header.encode(&mut w);
    value.encode(&mut w);
    debug_assert_eq!(w.missing(), 0);
    bytes
}

/// The writer's end of a buffer whose image has `N` bytes, header included.
struct BufferWriter<const N: usize, T> {
    entry: EntryHandleMut<ipc::Service, u32, [u8; N]>,
    holds: PhantomData<T>,
}

impl<const N: usize, T: Plain> BufferWriter<N, T> {
    fn write(&self, header: &Header, value: &T) {
        self.entry.update_with_copy(image(header, value));
    }
}

/// A reader's end of a buffer.
struct BufferReader<const N: usize, T> {
    entry: EntryHandle<ipc::Service, u32, [u8; N]>,
    holds: PhantomData<T>,
}

impl<const N: usize, T: Plain> BufferReader<N, T> {
    fn read(&self) -> Result<(Header, T), DecodeError> {
        let image: [u8; N] = *self.entry.get();
        let mut r = Reader::new(&image);
        Ok((Header::decode(&mut r)?, T::decode(&mut r)?))
    }
}

macro_rules! services {
    ($(
        $(#[doc = $doc:literal])*
        $service:ident ( $writer:ident, $reader:ident ) = $outputs:ident {
            $( $key:literal $buffer:ident : $type:ty, )+
        }
    )+) => {
        /// The services of a run: for each, its name, and the names and schemas of its buffers in the order
        /// of their keys.
        pub const SERVICES: &[(&str, &[(&str, Schema)])] = &[ $(
            (stringify!($service), &[ $( (stringify!($buffer), <$type as Plain>::SCHEMA), )+ ]),
        )+ ];

        $(
            $(#[doc = $doc])*
            ///
            /// The writer's ends of the buffers.
            pub struct $writer {
                $( $buffer: BufferWriter<{ image_size::<$type>() }, $type>, )+
            }

            impl $writer {
                /// Create the service and its buffers, zeroed.
                pub(super) fn create(node: &Node<ipc::Service>, epoch: Epoch) -> Result<Self, SharedMemoryError> {
                    let failed = |what: &dyn Debug| SharedMemoryError::service(stringify!($service), what);
                    let name = super::runs::service_name(stringify!($service), epoch)?;
                    let service = node
                        .service_builder(&name)
                        .blackboard_creator::<u32>()
                        .max_readers(super::runs::MAX_READERS)
                        .max_nodes(super::runs::MAX_READERS + 1)
                        $( .add($key, image::<{ image_size::<$type>() }, _>(&Header::ZERO, &<$type as Plain>::ZERO)) )+
                        .create()
                        .map_err(|error| failed(&error))?;
                    let port = service.writer_builder().create().map_err(|error| failed(&error))?;
                    Ok(Self { $(
                        $buffer: BufferWriter {
                            entry: port.entry(&$key).map_err(|error| failed(&error))?,
                            holds: PhantomData,
                        },
                    )+ })
                }

                /// Write all buffers.
                pub fn write(&self, outputs: &$outputs) {
                    $( self.$buffer.write(&outputs.header, &outputs.$buffer); )+
                }
            }

            $(#[doc = $doc])*
            ///
            /// A reader's ends of the buffers.
            pub struct $reader {
                $( $buffer: BufferReader<{ image_size::<$type>() }, $type>, )+
            }

            impl $reader {
                /// Open the service.
                pub(super) fn open(node: &Node<ipc::Service>, epoch: Epoch) -> Result<Self, SharedMemoryError> {
                    let failed = |what: &dyn Debug| SharedMemoryError::service(stringify!($service), what);
                    let name = super::runs::service_name(stringify!($service), epoch)?;
                    let service = node
                        .service_builder(&name)
                        .blackboard_opener::<u32>()
                        .open()
                        .map_err(|error| failed(&error))?;
                    let port = service.reader_builder().create().map_err(|error| failed(&error))?;
                    Ok(Self { $(
                        $buffer: BufferReader {
                            entry: port.entry(&$key).map_err(|error| failed(&error))?,
                            holds: PhantomData,
                        },
                    )+ })
                }

                /// The latest buffers; `None` if they were being written meanwhile.
                pub fn read(&self) -> Result<Option<$outputs>, DecodeError> {
                    let mut outputs = <$outputs>::default();
                    let mut stamps = [ $( {
                        let (header, value) = self.$buffer.read()?;
                        outputs.$buffer = value;
                        header
                    }, )+ ]
                    .into_iter();
                    let first = stamps.next().unwrap_or_default();
                    outputs.header = first;
                    Ok(stamps.all(|header| header == first).then_some(outputs))
                }
            }
        )+
    };
}

services! {
    /// Task (V.4.2).
    task(TaskWriter, TaskReader) = TaskOutputs {
        0 status: HwsStatus,
        1 subtask: SubtaskCommand,
        2 data_base: DataBaseCommand,
        3 poses: [ChangingPose; TASK_POSES],
    }
    /// Subtask (V.3.2).
    subtask(SubtaskWriter, SubtaskReader) = SubtaskOutputs {
        0 status: SubtaskStatus,
        1 emove: EmoveCommand,
        2 pedestal: PedestalCommand,
        3 poses: [ChangingPose; SUBTASK_POSES],
    }
    /// E-move (V.2.2).
    emove(EmoveWriter, EmoveReader) = EmoveOutputs {
        0 status: EmoveStatus,
        1 prim: PrimCommand,
        2 quick_change: QuickChangeCommand,
        3 grip: GripCommand,
        4 v_grip: JawsCommand,
        5 tool_grip: JawsCommand,
        6 dormant: Dormancy,
        7 vision: VisionRequest,
        8 poses: [ChangingPose; EMOVE_POSES],
    }
    /// Prim (V.1.2).
    prim(PrimWriter, PrimReader) = PrimOutputs {
        0 status: PrimStatus,
        1 t3i: T3iCommand,
        2 joystick_leds: u8,
        3 poses: [ChangingPose; PRIM_POSES],
    }
    /// T3 Interface (VI.1.2).
    t3i(T3iWriter, T3iReader) = T3iOutputs {
        0 status: T3iStatus,
        1 link_tx: LinkBytes,
    }
    /// Quick Change (VI.2.2).
    quick_change(QuickChangeWriter, QuickChangeReader) = QuickChangeOutputs {
        0 status: QuickChangeStatus,
        1 valves: QuickChangeValves,
    }
    /// Grip (VI.3.2).
    grip(GripWriter, GripReader) = GripOutputs {
        0 status: GripStatus,
        1 valves: GripValves,
    }
    /// V-Grip (VI.4.2).
    v_grip(VGripWriter, VGripReader) = JawsOutputs {
        0 status: JawsStatus,
        1 valves: JawValves,
    }
    /// Tool-Grip (VI.5).
    tool_grip(ToolGripWriter, ToolGripReader) = JawsOutputs {
        0 status: JawsStatus,
        1 valves: JawValves,
    }
    /// Active Pedestal (VI.7.2).
    pedestal(PedestalWriter, PedestalReader) = PedestalOutputs {
        0 status: PedestalStatus,
        1 hand: GripCommand,
        2 table: TableCommand,
    }
    /// Hand of the pedestal.
    hand(HandWriter, HandReader) = GripOutputs {
        0 status: GripStatus,
        1 valves: GripValves,
    }
    /// Rotary table of the pedestal.
    table(TableWriter, TableReader) = TableOutputs {
        0 status: TableStatus,
        1 motor: MotorCommand,
    }
    /// The workstation controller.
    hwsc(HwscWriter, HwscReader) = HwscOutputs {
        0 command: HwsCommand,
    }
    /// The Data System.
    data_base(DataBaseWriter, DataBaseReader) = DataBaseOutputs {
        0 status: DataBaseStatus,
    }
    /// An Active Pedestal that is a system of its own.
    outside_pedestal(OutsidePedestalWriter, OutsidePedestalReader) = OutsidePedestalOutputs {
        0 sent: OutsidePedestal,
    }
    /// The devices of the cell.
    devices(DevicesWriter, DevicesReader) = DevicesOutputs {
        0 inputs: DeviceInputs,
    }
    /// The executive.
    executive(ExecutiveWriter, ExecutiveReader) = ExecutiveOutputs {
        0 pulse: Pulse,
    }
}

/// Version of the layout: a hash of the names and schemas of all services and buffers. Programs that were
/// built with different layouts never read each other's bytes.
#[must_use]
pub fn layout_version() -> u32 {
    let mut digest = Digest::new();
    add_schema(&mut digest, &Header::SCHEMA);
    for (service, buffers) in SERVICES {
        add_text(&mut digest, service);
        for (buffer, schema) in *buffers {
            add_text(&mut digest, buffer);
            add_schema(&mut digest, schema);
        }
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
            add_text(digest, "union");
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
        Schema::Record(of) => {
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
        interface::{CommonMemory, ExternalInputs},
        plain::{UnionSchema, UnionVariant},
    };
    use std::collections::BTreeSet;

    /// The services together carry every field of common memory and of the external inputs: their schemas,
    /// headers apart, are those of the records.
    #[test]
    fn every_buffer_of_common_memory_is_published() {
        let processes = CommonMemory::RECORD.fields.len();
        for (process, (service, buffers)) in CommonMemory::RECORD.fields.iter().zip(SERVICES) {
            assert_eq!(process.name, *service);
            let Schema::Record(outputs) = process.schema else { panic!("{service} is a record") };
            let names: Vec<_> =
                outputs.fields.iter().map(|field| (field.name, field.schema)).skip(1).collect();
            assert_eq!(outputs.fields[0].schema, Header::SCHEMA);
            assert_eq!(names, buffers.to_vec());
        }
        // What comes from outside has a buffer each, but for the generation of the task data: it is in the pulse.
        let published = || SERVICES[processes..].iter().flat_map(|(_, buffers)| buffers.iter());
        for field in ExternalInputs::RECORD.fields {
            let found = published().any(|(_, schema)| match schema {
                Schema::Record(record) => *schema == field.schema || record.fields.contains(field),
                _ => false,
            });
            assert!(found, "{} is not published", field.name);
        }
    }

    #[test]
    fn the_layout_version_depends_on_every_word() {
        let version = |schema: &Schema| {
            let mut digest = Digest::new();
            add_schema(&mut digest, schema);
            digest.value()
        };
        assert_ne!(version(&Schema::Text(10)), version(&Schema::Text(12)));
        assert_ne!(version(&Schema::Array(&Schema::U8, 3)), version(&Schema::Array(&Schema::I16, 3)));
        assert_ne!(version(&HwsStatus::SCHEMA), version(&SubtaskStatus::SCHEMA));
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
