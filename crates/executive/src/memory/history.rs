//! The headers of the last ten seconds, in a separate service.
//!
//! For readers that see only some ticks, the run keeps the headers of all processes for [`HISTORY_TICKS`] ticks in a
//! ring with one slot per tick, of about a kilobyte.

use iceoryx2::{node::Node, prelude::ipc};
use interfaces::{CommonMemory, Header, PROCESS_COUNT, ProcessId};
use rcs_core::{Plain, plain::DecodeError, tick::Tick};

use super::{
    error::SharedMemoryError,
    layout::{AllHeaders, Epoch, HISTORY},
    runs,
    slot::{self, NewService, ServiceReader, SlotReader, SlotWriter, UNWRITTEN},
};

/// Number of ticks whose headers are kept: 10 s.
pub const HISTORY_TICKS: u32 = 250;
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Headers {
    pub tick: Tick,
    pub headers: [Header; PROCESS_COUNT], // in the order of [`ProcessId`]
}

impl Headers {
    #[must_use]
    pub fn of_process(&self, process: ProcessId) -> &Header {
        &self.headers[process.position()]
    }
}

fn place(tick: Tick) -> usize {
    usize::try_from(tick.0 % u64::from(HISTORY_TICKS)).unwrap_or_default()
}

const SIZE: usize = slot::size::<AllHeaders>();

pub(super) struct HistoryWriter(Vec<SlotWriter<SIZE, AllHeaders>>);

impl HistoryWriter {
    pub(super) fn create(node: &Node<ipc::Service>, epoch: Epoch) -> Result<Self, SharedMemoryError> {
        let new = NewService::new(node, HISTORY, epoch, runs::MAX_READERS)?;
        let new =
            (0..HISTORY_TICKS).fold(new, |new, key| new.slot::<SIZE, _>(key, UNWRITTEN, &AllHeaders::ZERO));
        let service = new.create()?;
        (0..HISTORY_TICKS).map(|key| service.slot(key)).collect::<Result<_, _>>().map(Self)
    }

    /// Write the headers of a tick over those of ten seconds earlier. Does not allocate.
    pub(super) fn write(&mut self, tick: Tick, memory: &CommonMemory) {
        let Some(slot) = self.0.get_mut(place(tick)) else { return };
        let mut headers = AllHeaders::ZERO;
        for (header, process) in headers.iter_mut().zip(ProcessId::ALL) {
            *header = *memory.header(*process);
        }
        slot.write(tick, &headers);
    }
}

pub(super) struct HistoryReader(Vec<SlotReader<SIZE, AllHeaders>>);

impl HistoryReader {
    pub(super) fn open(node: &Node<ipc::Service>, epoch: Epoch) -> Result<Self, SharedMemoryError> {
        let service = ServiceReader::open(node, HISTORY, epoch)?;
        (0..HISTORY_TICKS).map(|key| service.slot(key)).collect::<Result<_, _>>().map(Self)
    }

    /// The headers of the ticks after `after` up to `last`, the oldest first, without overwritten ones.
    pub(super) fn read(&self, after: Tick, last: Tick) -> Result<Vec<Headers>, DecodeError> {
        let first = after.next().0.max(last.next().0.saturating_sub(u64::from(HISTORY_TICKS)));
        let mut found = Vec::new();
        for tick in (first..=last.0).map(Tick) {
            let Some(slot) = self.0.get(place(tick)) else { continue };
            found.extend(slot.read_at(tick)?.map(|headers| Headers { tick, headers }));
        }
        Ok(found)
    }
}
