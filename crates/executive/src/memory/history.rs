//! The headers of the last ten seconds, in a separate service.
//!
//! A reader that reads every 80 ms sees at best every second tick, and one that has just attached sees no earlier tick.
//! So the run keeps the headers of all processes for [`HISTORY_TICKS`] ticks in a ring with one entry per tick. A tick
//! writes one entry of about a kilobyte; a reader takes all of them, or those since its last read.

use iceoryx2::{
    node::Node,
    port::{reader::EntryHandle, writer::EntryHandleMut},
    prelude::ipc,
};
use interfaces::{CommonMemory, Header, PROCESS_COUNT, ProcessId};
use rcs_core::{
    Plain,
    plain::{DecodeError, from_bytes, to_bytes},
    tick::Tick,
};

use super::{error::SharedMemoryError, layout::Epoch, runs};

/// Number of ticks whose headers are kept: 10 s.
pub const HISTORY_TICKS: u32 = 250;
/// The name of the service.
pub(super) const HISTORY: &str = "history";

/// The headers of all processes after a tick.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Headers {
    /// The tick.
    pub tick: Tick,
    /// The headers in the order of [`ProcessId`].
    pub headers: [Header; PROCESS_COUNT],
}

impl Headers {
    /// The headers in common memory.
    #[must_use]
    pub fn of(tick: Tick, memory: &CommonMemory) -> Self {
        let mut headers = [Header::default(); PROCESS_COUNT];
        for (header, process) in headers.iter_mut().zip(ProcessId::ALL) {
            *header = *memory.header(*process);
        }
        Self { tick, headers }
    }

    /// The header of a process.
    #[must_use]
    pub fn of_process(&self, process: ProcessId) -> &Header {
        &self.headers[process.position()]
    }
}

/// Index of a tick's entry.
fn place(tick: Tick) -> usize {
    // The index is less than 250.
    usize::try_from(tick.0 % u64::from(HISTORY_TICKS)).unwrap_or_default()
}

/// The writer's end.
pub(super) struct HistoryWriter(Vec<EntryHandleMut<ipc::Service, u32, [u8; Headers::SIZE]>>);

impl HistoryWriter {
    /// Create the service, with entries that belong to no tick.
    pub(super) fn create(node: &Node<ipc::Service>, epoch: Epoch) -> Result<Self, SharedMemoryError> {
        let failed = |what: &dyn std::fmt::Debug| SharedMemoryError::service(HISTORY, what);
        let name = runs::service_name(HISTORY, epoch)?;
        let creator = node
            .service_builder(&name)
            .blackboard_creator::<u32>()
            .max_readers(runs::MAX_READERS)
            .max_nodes(runs::MAX_READERS + 1);
        let creator = (0..HISTORY_TICKS)
            .fold(creator, |creator, key| creator.add::<[u8; Headers::SIZE]>(key, to_bytes(&Headers::ZERO)));
        let factory = creator.create().map_err(|error| failed(&error))?;
        let port = factory.writer_builder().create().map_err(|error| failed(&error))?;
        let entry = |key| port.entry(&key).map_err(|error| failed(&error));
        (0..HISTORY_TICKS).map(entry).collect::<Result<_, _>>().map(Self)
    }

    /// Write the headers of a tick over those of ten seconds earlier. Does not allocate.
    pub(super) fn write(&self, tick: Tick, memory: &CommonMemory) {
        if let Some(entry) = self.0.get(place(tick)) {
            entry.update_with_copy(to_bytes(&Headers::of(tick, memory)));
        }
    }
}

/// A reader's end.
pub(super) struct HistoryReader(Vec<EntryHandle<ipc::Service, u32, [u8; Headers::SIZE]>>);

impl HistoryReader {
    /// Open the service.
    pub(super) fn open(node: &Node<ipc::Service>, epoch: Epoch) -> Result<Self, SharedMemoryError> {
        let failed = |what: &dyn std::fmt::Debug| SharedMemoryError::service(HISTORY, what);
        let name = runs::service_name(HISTORY, epoch)?;
        let factory =
            node.service_builder(&name).blackboard_opener::<u32>().open().map_err(|error| failed(&error))?;
        let port = factory.reader_builder().create().map_err(|error| failed(&error))?;
        let entry = |key| port.entry(&key).map_err(|error| failed(&error));
        (0..HISTORY_TICKS).map(entry).collect::<Result<_, _>>().map(Self)
    }

    /// The headers of the ticks after `after` up to `last`, the oldest first. Ticks that were overwritten in the
    /// meantime are left out.
    pub(super) fn read(&self, after: Tick, last: Tick) -> Result<Vec<Headers>, DecodeError> {
        let first = after.next().0.max(last.next().0.saturating_sub(u64::from(HISTORY_TICKS)));
        let mut found = Vec::new();
        for tick in (first..=last.0).map(Tick) {
            let Some(entry) = self.0.get(place(tick)) else { continue };
            let image: [u8; Headers::SIZE] = *entry.get();
            let headers: Headers = from_bytes(&image)?;
            if headers.tick == tick {
                found.push(headers);
            }
        }
        Ok(found)
    }
}
