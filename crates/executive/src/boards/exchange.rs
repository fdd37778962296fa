//! Data exchange of the boards: the outputs of each process, doubled by tick parity, and its state.
//!
//! Each process has one blackboard service with three entries: its outputs in even ticks, its outputs in odd ticks, and
//! its state. An entry is a byte image after the number of the tick that wrote it; iceoryx2 transfers it as a whole or
//! not at all. A reader that finds another number than the one it needs reads nothing: the process's outputs then keep
//! their old stamp, and its neighbours treat it as lost (docs/design/handshake.md "Stamp").
//!
//! A service belongs to the board on which the process runs, and its name contains the board's epoch: a board that
//! replaces a killed one creates services of the next epoch.

use std::{fmt::Debug, marker::PhantomData};

use iceoryx2::{
    node::Node,
    port::{reader::EntryHandle, writer::EntryHandleMut},
    prelude::ipc,
};
use interfaces::{CommonMemory, for_each_process, process::Process};
use levels::{
    ladder::{LadderState, ProcessId},
    processes::*,
};
use rcs_core::{
    Plain,
    plain::{DecodeError, Reader, Writer},
    tick::Tick,
};
use taskdata::files::TaskData;

use super::{BOARDS, Board};
use crate::memory::{SharedMemoryError, layout::Epoch, runs::service_name};

/// Greatest number of readers of a board's blackboards: the other boards, board 0, and a board that takes over.
pub(super) const READERS: usize = BOARDS + 2;

type StateOf<P> = <P as Process<TaskData<'static>>>::State;
type OutputsOf<P> = <P as Process<TaskData<'static>>>::Outputs;

/// Size of an entry, bytes.
pub(super) const fn entry_size<T: Plain>() -> usize {
    Tick::SIZE + T::SIZE
}

/// Key of the state; 0 and 1 are the keys of the halves.
const STATE: u32 = 2;

/// Index of the half for a tick.
const fn half(tick: Tick) -> usize {
    if tick.0.is_multiple_of(2) { 0 } else { 1 }
}

/// The writer's end of an entry of `N` bytes that contains a `T`.
pub(super) struct EntryWriter<const N: usize, T> {
    entry: EntryHandleMut<ipc::Service, u32, [u8; N]>,
    holds: PhantomData<T>,
}

impl<const N: usize, T: Plain> EntryWriter<N, T> {
    pub(super) const fn new(entry: EntryHandleMut<ipc::Service, u32, [u8; N]>) -> Self {
        Self { entry, holds: PhantomData }
    }

    pub(super) fn write(&self, tick: Tick, value: &T) {
        self.entry.update_with_copy(stamped(tick, value));
    }
}

/// The bytes of an entry in shared memory.
pub(super) fn stamped<const N: usize, T: Plain>(tick: Tick, value: &T) -> [u8; N] {
    let mut bytes = [0; N];
    let mut w = Writer::new(&mut bytes);
    tick.encode(&mut w);
    value.encode(&mut w);
    debug_assert_eq!(w.missing(), 0);
    bytes
}

/// A reader's end of an entry.
pub(super) struct EntryReader<const N: usize, T> {
    entry: EntryHandle<ipc::Service, u32, [u8; N]>,
    holds: PhantomData<T>,
}

impl<const N: usize, T: Plain> EntryReader<N, T> {
    pub(super) const fn new(entry: EntryHandle<ipc::Service, u32, [u8; N]>) -> Self {
        Self { entry, holds: PhantomData }
    }

    /// The tick that wrote the entry, and the value.
    pub(super) fn read(&self) -> Result<(Tick, T), DecodeError> {
        let image: [u8; N] = *self.entry.get();
        let mut r = Reader::new(&image);
        Ok((Tick::decode(&mut r)?, T::decode(&mut r)?))
    }

    /// The value, if it was written in `tick`; otherwise it is not decoded.
    pub(super) fn read_at(&self, tick: Tick) -> Result<Option<T>, DecodeError> {
        let image: [u8; N] = *self.entry.get();
        let mut r = Reader::new(&image);
        if Tick::decode(&mut r)? != tick {
            return Ok(None);
        }
        T::decode(&mut r).map(Some)
    }
}

/// The writer's ends of a process's entries: outputs of `N` bytes, state of `S`.
struct ProcessWriter<const N: usize, const S: usize, O, T> {
    halves: [EntryWriter<N, O>; 2],
    state: EntryWriter<S, T>,
}

impl<const N: usize, const S: usize, O: Plain, T: Plain> ProcessWriter<N, S, O, T> {
    fn create(
        node: &Node<ipc::Service>,
        service: &'static str,
        epoch: Epoch,
    ) -> Result<Self, SharedMemoryError> {
        let failed = |what: &dyn Debug| SharedMemoryError::service(service, what);
        let none = Tick::BEFORE_START;
        let factory = node
            .service_builder(&service_name(service, epoch)?)
            .blackboard_creator::<u32>()
            .max_readers(READERS)
            .max_nodes(READERS + 1)
            .add::<[u8; N]>(0, stamped(none, &O::ZERO))
            // No tick has written the odd half before tick 1.
            .add::<[u8; N]>(1, stamped(Tick(u64::MAX), &O::ZERO))
            .add::<[u8; S]>(STATE, stamped(none, &T::ZERO))
            .create()
            .map_err(|error| failed(&error))?;
        let port = factory.writer_builder().create().map_err(|error| failed(&error))?;
        let outputs = |key| port.entry(&key).map(EntryWriter::new).map_err(|error| failed(&error));
        let state = port.entry(&STATE).map_err(|error| failed(&error))?;
        Ok(Self { halves: [outputs(0)?, outputs(1)?], state: EntryWriter::new(state) })
    }

    fn write(&self, tick: Tick, outputs: &O, state: &T) {
        let [even, odd] = &self.halves;
        let place = if half(tick) == 0 { even } else { odd };
        place.write(tick, outputs);
        self.state.write(tick, state);
    }
}

/// A reader's ends of a process's entries.
struct ProcessReader<const N: usize, const S: usize, O, T> {
    halves: [EntryReader<N, O>; 2],
    state: EntryReader<S, T>,
}

impl<const N: usize, const S: usize, O: Plain, T: Plain> ProcessReader<N, S, O, T> {
    fn open(
        node: &Node<ipc::Service>,
        service: &'static str,
        epoch: Epoch,
    ) -> Result<Self, SharedMemoryError> {
        let failed = |what: &dyn Debug| SharedMemoryError::service(service, what);
        let factory = node
            .service_builder(&service_name(service, epoch)?)
            .blackboard_opener::<u32>()
            .open()
            .map_err(|error| failed(&error))?;
        let port = factory.reader_builder().create().map_err(|error| failed(&error))?;
        let outputs = |key| port.entry(&key).map(EntryReader::new).map_err(|error| failed(&error));
        let state = port.entry(&STATE).map_err(|error| failed(&error))?;
        Ok(Self { halves: [outputs(0)?, outputs(1)?], state: EntryReader::new(state) })
    }

    fn outputs(&self, tick: Tick) -> Result<Option<O>, DecodeError> {
        let [even, odd] = &self.halves;
        if half(tick) == 0 { even.read_at(tick) } else { odd.read_at(tick) }
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
        /// The writer's ends of a board's processes.
        pub struct Writers {
            $( $field: Option<ProcessWriter<
                { entry_size::<OutputsOf<$id>>() },
                { entry_size::<StateOf<$id>>() },
                OutputsOf<$id>,
                StateOf<$id>,
            >>, )+
        }

        impl Writers {
            /// Create the services of a board's processes.
            ///
            /// # Errors
            /// Errors of iceoryx2; if a service already exists, another process runs the same board.
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
            pub fn write(&self, tick: Tick, memory: &CommonMemory, state: &LadderState) {
                $( if let Some(process) = &self.$field {
                    process.write(tick, &memory.$field, &state.$field);
                } )+
            }
        }

        /// The readers' ends of a board's processes.
        pub struct Readers {
            $( $field: Option<ProcessReader<
                { entry_size::<OutputsOf<$id>>() },
                { entry_size::<StateOf<$id>>() },
                OutputsOf<$id>,
                StateOf<$id>,
            >>, )+
        }

        impl Readers {
            /// Open the services of a board's processes.
            ///
            /// # Errors
            /// Errors of iceoryx2; a service that does not exist yet may be created later.
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

            /// Read the outputs of the processes in `tick`; outputs of a process that did not write in it are
            /// unchanged. Returns true if all wrote. Does not allocate.
            ///
            /// # Errors
            /// If bytes are not a valid record.
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

            /// Read the states of the processes after `tick`. Does not allocate.
            ///
            /// # Errors
            /// If bytes are not a valid record.
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
