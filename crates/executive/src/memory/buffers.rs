//! The buffers in shared memory, service by service.
//!
//! Each process has a service with one slot ([`super::slot`]), its output buffers. Further services have the external
//! inputs, the counts, the views of the cell and of the couplers, and the headers of the last ten seconds ([`super::history`]).

use iceoryx2::{node::Node, prelude::ipc};
use interfaces::{CommonMemory, ExternalInputs, for_each_process};
use rcs_core::{Plain, plain::DecodeError, tick::Tick};

use super::{
    cell::{CELL, CellView},
    error::SharedMemoryError,
    field::{FIELD, FieldView},
    history::{HistoryReader, HistoryWriter},
    layout::{EXECUTIVE, Epoch, OUTSIDE, Pulse},
    runs,
    slot::{self, NewService, ServiceReader, SlotReader, SlotWriter},
};

const ONLY: u32 = 0; // key of the only slot of a service

fn create<const N: usize, T: Plain>(
    node: &Node<ipc::Service>,
    service: &'static str,
    epoch: Epoch,
) -> Result<SlotWriter<N, T>, SharedMemoryError> {
    let new = NewService::new(node, service, epoch, runs::MAX_READERS)?;
    new.slot::<N, T>(ONLY, Tick::BEFORE_START, &T::ZERO).create()?.slot(ONLY)
}

fn open<const N: usize, T>(
    node: &Node<ipc::Service>,
    service: &'static str,
    epoch: Epoch,
) -> Result<SlotReader<N, T>, SharedMemoryError> {
    ServiceReader::open(node, service, epoch)?.slot(ONLY)
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
        pub struct Writers {
            $( $field: SlotWriter<{ slot::size::<$outputs>() }, $outputs>, )+
            outside: SlotWriter<{ slot::size::<ExternalInputs>() }, ExternalInputs>,
            pub(super) executive: SlotWriter<{ slot::size::<Pulse>() }, Pulse>,
            pub(super) cell: SlotWriter<{ slot::size::<CellView>() }, CellView>,
            pub(super) field: SlotWriter<{ slot::size::<FieldView>() }, FieldView>,
            history: HistoryWriter,
        }

        impl Writers {
            pub(super) fn create(node: &Node<ipc::Service>, epoch: Epoch) -> Result<Self, SharedMemoryError> {
                Ok(Self {
                    $( $field: create(node, stringify!($field), epoch)?, )+
                    outside: create(node, OUTSIDE, epoch)?,
                    executive: create(node, EXECUTIVE, epoch)?,
                    cell: create(node, CELL, epoch)?,
                    field: create(node, FIELD, epoch)?,
                    history: HistoryWriter::create(node, epoch)?,
                })
            }

            /// Write a tick: external inputs, outputs of the processes, their headers, then the pulse. Does not
            /// allocate.
            pub fn write(&mut self, inputs: &ExternalInputs, memory: &CommonMemory, pulse: &Pulse) {
                let tick = pulse.tick;
                self.outside.write(tick, inputs);
                $( self.$field.write(tick, &memory.$field); )+
                self.history.write(tick, memory);
                self.executive.write(tick, pulse);
            }
        }

        pub struct Readers {
            $( $field: SlotReader<{ slot::size::<$outputs>() }, $outputs>, )+
            pub(super) outside: SlotReader<{ slot::size::<ExternalInputs>() }, ExternalInputs>,
            pub(super) executive: SlotReader<{ slot::size::<Pulse>() }, Pulse>,
            pub(super) cell: SlotReader<{ slot::size::<CellView>() }, CellView>,
            pub(super) field: SlotReader<{ slot::size::<FieldView>() }, FieldView>,
            pub(super) history: HistoryReader,
        }

        impl Readers {
            pub(super) fn open(node: &Node<ipc::Service>, epoch: Epoch) -> Result<Self, SharedMemoryError> {
                Ok(Self {
                    $( $field: open(node, stringify!($field), epoch)?, )+
                    outside: open(node, OUTSIDE, epoch)?,
                    executive: open(node, EXECUTIVE, epoch)?,
                    cell: open(node, CELL, epoch)?,
                    field: open(node, FIELD, epoch)?,
                    history: HistoryReader::open(node, epoch)?,
                })
            }

            /// The outputs of all processes. Each is complete, but they may be of different ticks.
            pub fn processes(&self) -> Result<CommonMemory, DecodeError> {
                Ok(CommonMemory { $( $field: self.$field.read()?.1, )+ })
            }
        }
    };
}
for_each_process!(services);
