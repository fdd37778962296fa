use interfaces::{CommonMemory, ExternalInputs};
use rcs_core::{plain::DecodeError, tick::Tick};

use super::{
    announced::starting, buffers::Readers, cell::CellView, error::SharedMemoryError, field::FieldView,
    history::Headers, layout::Pulse, name::RunName, place, publish::FIRST_EPOCH, runs,
};

/// Number of attempts of a reader while the writer writes, which takes some microseconds of a tick.
const ATTEMPTS: usize = 1000;

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReadError {
    #[error("shared memory holds an invalid record: {0}")]
    Decode(#[from] DecodeError),
    /// The writer was in the middle of a tick at every attempt; the next call may succeed.
    #[error("the buffers were being written at every attempt")]
    Busy,
}

pub struct Attached {
    name: RunName,
    ports: Option<Ports>,
}

struct Ports {
    readers: Readers,
    _member: runs::RunNode,
}

impl Attached {
    /// Attach to a run by its name. Fails if no living run has it, its program has another layout, or it is before its
    /// first tick.
    pub fn open(name: &RunName) -> Result<Self, SharedMemoryError> {
        runs::find_living(name)?;
        if let Some(phase) = starting(name) {
            return Err(SharedMemoryError::Starting { run: name.clone(), phase });
        }
        let member = runs::enter(name, "reader")?;
        let ports = Ports { readers: Readers::open(&member, FIRST_EPOCH)?, _member: member };
        Ok(Self { name: name.clone(), ports: Some(ports) })
    }

    #[must_use]
    pub const fn name(&self) -> &RunName {
        &self.name
    }

    /// Common memory after one tick. Processes of a pedestal in another system can have an older stamp.
    pub fn memory(&self) -> Result<CommonMemory, ReadError> {
        let Some(Ports { readers, .. }) = &self.ports else { return Err(ReadError::Busy) };
        for _ in 0..ATTEMPTS {
            // The first and the last written slot are of one tick, so all others are too.
            let (tick, _) = readers.executive.read()?;
            let memory = readers.processes()?;
            if readers.outside.read()?.0 == tick {
                return Ok(memory);
            }
            std::thread::yield_now();
        }
        Err(ReadError::Busy)
    }

    pub fn external(&self) -> Result<ExternalInputs, ReadError> {
        let ports = self.ports.as_ref().ok_or(ReadError::Busy)?;
        Ok(ports.readers.outside.read()?.1)
    }

    pub fn pulse(&self) -> Result<Pulse, ReadError> {
        let ports = self.ports.as_ref().ok_or(ReadError::Busy)?;
        Ok(ports.readers.executive.read()?.1)
    }

    /// The headers of the ticks after `after`, the oldest first, of the last ten seconds.
    pub fn history(&self, after: Tick) -> Result<Vec<Headers>, ReadError> {
        let ports = self.ports.as_ref().ok_or(ReadError::Busy)?;
        let (last, _) = ports.readers.executive.read()?;
        Ok(ports.readers.history.read(after, last)?)
    }

    /// The view of the simulated cell, if there is one. It is published after its tick, so it may be a tick behind
    /// [`Self::memory`].
    pub fn cell(&self) -> Result<Option<CellView>, ReadError> {
        let ports = self.ports.as_ref().ok_or(ReadError::Busy)?;
        let (_, view) = ports.readers.cell.read()?;
        Ok((view.tick != Tick::BEFORE_START).then_some(view))
    }

    /// The couplers of a run with field I/O. Like [`Self::cell`], it may be a tick behind [`Self::memory`].
    pub fn field(&self) -> Result<Option<FieldView>, ReadError> {
        let ports = self.ports.as_ref().ok_or(ReadError::Busy)?;
        let (_, view) = ports.readers.field.read()?;
        Ok((view.tick != Tick::BEFORE_START).then_some(view))
    }
}

impl Drop for Attached {
    fn drop(&mut self) {
        drop(self.ports.take());
        // A living run or another reader keeps the files; `rcs-run clean` handles a failure.
        let _ = runs::remove_if_deserted(&self.name, &place::layout());
    }
}
