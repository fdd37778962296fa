//! The buffers in shared memory, service by service.
//!
//! Each process has a service with one entry, its output buffers as a byte image. Further services have the external
//! inputs, the executive's counts, the view of the simulated cell, and the headers of the last ten seconds
//! ([`super::history`]). iceoryx2 transfers an entry as a whole, so all buffers in an entry are of one tick.

use std::fmt::Debug;

use iceoryx2::{
    node::Node,
    port::{reader::EntryHandle, writer::EntryHandleMut},
    prelude::ipc,
};
use interfaces::{CommonMemory, ExternalInputs, for_each_process};
use rcs_core::{
    Plain,
    plain::{DecodeError, from_bytes, to_bytes},
};
use std::marker::PhantomData;

use super::{
    cell::{CELL, CellView},
    error::SharedMemoryError,
    history::{HistoryReader, HistoryWriter},
    layout::{EXECUTIVE, Epoch, OUTSIDE, Outside, Pulse},
    runs,
};

/// Key of the only entry of a service.
const ENTRY: u32 = 0;

/// The writer's end of a service whose entry has `N` bytes.
pub struct ServiceWriter<const N: usize, T> {
    entry: EntryHandleMut<ipc::Service, u32, [u8; N]>,
    holds: PhantomData<T>,
}

impl<const N: usize, T: Plain> ServiceWriter<N, T> {
    /// Create the service and its entry, filled with zeros.
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
        /// The writer's ends of all services.
        pub struct Writers {
            $( $field: ServiceWriter<{ <$outputs as Plain>::SIZE }, $outputs>, )+
            outside: ServiceWriter<{ Outside::SIZE }, Outside>,
            /// The executive's counts.
            pub executive: ServiceWriter<{ Pulse::SIZE }, Pulse>,
            /// The view of the simulated cell.
            pub(super) cell: ServiceWriter<{ CellView::SIZE }, CellView>,
            history: HistoryWriter,
        }

        impl Writers {
            /// Create all services.
            ///
            /// # Errors
            /// Errors of iceoryx2.
            pub(super) fn create(node: &Node<ipc::Service>, epoch: Epoch) -> Result<Self, SharedMemoryError> {
                Ok(Self {
                    $( $field: ServiceWriter::create(node, stringify!($field), epoch)?, )+
                    outside: ServiceWriter::create(node, OUTSIDE, epoch)?,
                    executive: ServiceWriter::create(node, EXECUTIVE, epoch)?,
                    cell: ServiceWriter::create(node, CELL, epoch)?,
                    history: HistoryWriter::create(node, epoch)?,
                })
            }

            /// Write a tick in this order: external inputs, outputs of the processes, their headers in the history, and
            /// the pulse. Does not allocate.
            pub fn write(&self, inputs: &ExternalInputs, memory: &CommonMemory, pulse: &Pulse) {
                self.outside.write(&Outside { tick: pulse.tick, inputs: *inputs });
                $( self.$field.write(&memory.$field); )+
                self.history.write(pulse.tick, memory);
                self.executive.write(pulse);
            }
        }

        /// A reader's ends of all services.
        pub struct Readers {
            $( $field: ServiceReader<{ <$outputs as Plain>::SIZE }, $outputs>, )+
            /// External inputs.
            pub outside: ServiceReader<{ Outside::SIZE }, Outside>,
            /// The executive's counts.
            pub executive: ServiceReader<{ Pulse::SIZE }, Pulse>,
            /// The view of the simulated cell.
            pub(super) cell: ServiceReader<{ CellView::SIZE }, CellView>,
            /// The headers of the last ten seconds.
            pub(super) history: HistoryReader,
        }

        impl Readers {
            /// Open all services.
            ///
            /// # Errors
            /// Errors of iceoryx2.
            pub(super) fn open(node: &Node<ipc::Service>, epoch: Epoch) -> Result<Self, SharedMemoryError> {
                Ok(Self {
                    $( $field: ServiceReader::open(node, stringify!($field), epoch)?, )+
                    outside: ServiceReader::open(node, OUTSIDE, epoch)?,
                    executive: ServiceReader::open(node, EXECUTIVE, epoch)?,
                    cell: ServiceReader::open(node, CELL, epoch)?,
                    history: HistoryReader::open(node, epoch)?,
                })
            }

            /// The outputs of all processes. Each is complete, but they may be of different ticks.
            ///
            /// # Errors
            /// If bytes are not a valid record.
            pub fn processes(&self) -> Result<CommonMemory, DecodeError> {
                Ok(CommonMemory { $( $field: self.$field.read()?, )+ })
            }
        }
    };
}
for_each_process!(services);
