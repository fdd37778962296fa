//! Data exchange of the boards: the outputs of each process, doubled by tick parity, and its state.
//!
//! Each process has one service with three slots ([`crate::memory::slot`]). A reader needs the stamp of one tick. If it
//! finds another stamp, it reads nothing: the outputs keep their old stamp, and the neighbours treat the process as
//! lost (docs/design/handshake.md "Stamp"). The service's name contains the board's epoch: a board that replaces a
//! killed one creates services of the next epoch.

use iceoryx2::{node::Node, prelude::ipc};
use interfaces::{CommonMemory, for_each_process, process::Process};
use levels::{
    ladder::{LadderState, ProcessId},
    processes::*,
};
use rcs_core::{Plain, plain::DecodeError, tick::Tick};
use taskdata::files::TaskData;

use super::{BOARDS, Board};
use crate::memory::{
    SharedMemoryError,
    layout::Epoch,
    slot::{self, NewService, ServiceReader, SlotReader, SlotWriter, UNWRITTEN},
};

/// Greatest number of readers of a board's blackboards: the other boards, board 0, and a board that takes over.
pub(super) const READERS: usize = BOARDS + 2;

type StateOf<P> = <P as Process<TaskData<'static>>>::State;
type OutputsOf<P> = <P as Process<TaskData<'static>>>::Outputs;

const EVEN: u32 = 0;
const ODD: u32 = 1;
const STATE: u32 = 2;

const fn outputs_of(tick: Tick) -> u32 {
    if tick.0.is_multiple_of(2) { EVEN } else { ODD }
}

struct ProcessWriter<const N: usize, const S: usize, O, T> {
    even: SlotWriter<N, O>,
    odd: SlotWriter<N, O>,
    state: SlotWriter<S, T>,
}

impl<const N: usize, const S: usize, O: Plain, T: Plain> ProcessWriter<N, S, O, T> {
    fn create(
        node: &Node<ipc::Service>,
        service: &'static str,
        epoch: Epoch,
    ) -> Result<Self, SharedMemoryError> {
        let none = Tick::BEFORE_START;
        let service = NewService::new(node, service, epoch, READERS)?
            .slot::<N, O>(EVEN, none, &O::ZERO)
            // No tick has written the odd half before tick 1.
            .slot::<N, O>(ODD, UNWRITTEN, &O::ZERO)
            .slot::<S, T>(STATE, none, &T::ZERO)
            .create()?;
        Ok(Self { even: service.slot(EVEN)?, odd: service.slot(ODD)?, state: service.slot(STATE)? })
    }

    fn write(&mut self, tick: Tick, outputs: &O, state: &T) {
        let half = if outputs_of(tick) == EVEN { &mut self.even } else { &mut self.odd };
        half.write(tick, outputs);
        self.state.write(tick, state);
    }
}

struct ProcessReader<const N: usize, const S: usize, O, T> {
    even: SlotReader<N, O>,
    odd: SlotReader<N, O>,
    state: SlotReader<S, T>,
}

impl<const N: usize, const S: usize, O: Plain, T: Plain> ProcessReader<N, S, O, T> {
    fn open(
        node: &Node<ipc::Service>,
        service: &'static str,
        epoch: Epoch,
    ) -> Result<Self, SharedMemoryError> {
        let service = ServiceReader::open(node, service, epoch)?;
        Ok(Self { even: service.slot(EVEN)?, odd: service.slot(ODD)?, state: service.slot(STATE)? })
    }

    fn outputs(&self, tick: Tick) -> Result<Option<O>, DecodeError> {
        let half = if outputs_of(tick) == EVEN { &self.even } else { &self.odd };
        half.read_at(tick)
    }
}

macro_rules! exchange {
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
            $( $field: Option<ProcessWriter<
                { slot::size::<OutputsOf<$id>>() },
                { slot::size::<StateOf<$id>>() },
                OutputsOf<$id>,
                StateOf<$id>,
            >>, )+
        }

        impl Writers {
            /// Create the services of a board's processes. If a service exists, another process runs the same board.
            pub fn create(
                node: &Node<ipc::Service>,
                board: Board,
                epoch: Epoch,
            ) -> Result<Self, SharedMemoryError> {
                Ok(Self { $(
                    $field: (ProcessId::$id.board() == board.number())
                        .then(|| ProcessWriter::create(node, concat!("exchange/", stringify!($field)), epoch))
                        .transpose()?,
                )+ })
            }

            /// Write the outputs and states of the board's processes after `tick`. Does not allocate.
            pub fn write(&mut self, tick: Tick, memory: &CommonMemory, state: &LadderState) {
                $( if let Some(process) = &mut self.$field {
                    process.write(tick, &memory.$field, &state.$field);
                } )+
            }
        }

        pub struct Readers {
            $( $field: Option<ProcessReader<
                { slot::size::<OutputsOf<$id>>() },
                { slot::size::<StateOf<$id>>() },
                OutputsOf<$id>,
                StateOf<$id>,
            >>, )+
        }

        impl Readers {
            /// Open the services of a board's processes; one that does not exist yet may be created later.
            pub fn open(
                node: &Node<ipc::Service>,
                board: Board,
                epoch: Epoch,
            ) -> Result<Self, SharedMemoryError> {
                Ok(Self { $(
                    $field: (ProcessId::$id.board() == board.number())
                        .then(|| ProcessReader::open(node, concat!("exchange/", stringify!($field)), epoch))
                        .transpose()?,
                )+ })
            }

            /// Read the outputs of the processes in `tick`. A process that did not write keeps its outputs.
            /// Returns true if all wrote. Does not allocate.
            pub fn outputs(&self, tick: Tick, memory: &mut CommonMemory) -> Result<bool, DecodeError> {
                let mut complete = true;
                $( if let Some(process) = &self.$field {
                    match process.outputs(tick)? {
                        Some(outputs) => memory.$field = outputs,
                        None => complete = false,
                    }
                } )+
                Ok(complete)
            }

            /// Read the states of the processes after `tick`. Does not allocate. Fails if bytes are not a valid record.
            pub fn states(&self, tick: Tick, states: &mut LadderState) -> Result<(), DecodeError> {
                $( if let Some(process) = &self.$field
                    && let Some(state) = process.state.read_at(tick)?
                {
                    states.$field = state;
                } )+
                Ok(())
            }
        }
    };
}

for_each_process!(exchange);
