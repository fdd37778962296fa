//! The readers' side: reads the buffers of a run without disturbing it.

use interfaces::{CommonMemory, ExternalInputs};
use rcs_core::{plain::DecodeError, tick::Tick};

use super::{
    announced::starting, buffers::Readers, cell::CellView, error::SharedMemoryError, history::Headers,
    layout::Pulse, name::RunName, place, publish::FIRST_EPOCH, runs,
};

/// Number of attempts of a reader while the writer writes, which takes some microseconds of a tick.
const ATTEMPTS: usize = 1000;

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReadError {
    /// The bytes are not legal records.
    #[error("shared memory holds an invalid record: {0}")]
    Decode(#[from] DecodeError),
    /// The writer was in the middle of a tick at every attempt; the next call may succeed.
    #[error("the buffers were being written at every attempt")]
    Busy,
}

/// A reader that is attached to a run. Dropping it detaches.
pub struct Attached {
    name: RunName,
    // Dropped before the files are removed, if this is the last process to leave.
    ports: Option<Ports>,
}

struct Ports {
    readers: Readers,
    _member: runs::RunNode,
}

impl Attached {
    /// Attach to a run by its name.
    ///
    /// # Errors
    /// [`SharedMemoryError::NoSuchRun`] if no living run has the name, [`SharedMemoryError::OtherLayout`] if its
    /// program has another layout, [`SharedMemoryError::Starting`] before its first tick, otherwise the error of
    /// iceoryx2.
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

    /// Common memory after one tick: all processes have its stamp, except those of a pedestal in another system that
    /// does not answer, which have an older one.
    ///
    /// # Errors
    /// [`ReadError`].
    pub fn memory(&self) -> Result<CommonMemory, ReadError> {
        let Some(Ports { readers, .. }) = &self.ports else { return Err(ReadError::Busy) };
        for _ in 0..ATTEMPTS {
            // The slot written last is read first, and the one written first is read last: if both are of one tick,
            // all others are too.
            let (tick, _) = readers.executive.read()?;
            let memory = readers.processes()?;
            if readers.outside.read()?.0 == tick {
                return Ok(memory);
            }
            std::thread::yield_now();
        }
        Err(ReadError::Busy)
    }

    /// The external inputs of the last tick.
    ///
    /// # Errors
    /// [`ReadError`].
    pub fn external(&self) -> Result<ExternalInputs, ReadError> {
        let ports = self.ports.as_ref().ok_or(ReadError::Busy)?;
        Ok(ports.readers.outside.read()?.1)
    }

    /// The executive's counts of the run.
    ///
    /// # Errors
    /// [`ReadError`].
    pub fn pulse(&self) -> Result<Pulse, ReadError> {
        let ports = self.ports.as_ref().ok_or(ReadError::Busy)?;
        Ok(ports.readers.executive.read()?.1)
    }

    /// The headers of the ticks after `after`, the oldest first: at most those of the last ten seconds.
    /// [`Tick::BEFORE_START`] returns all of them.
    ///
    /// # Errors
    /// [`ReadError`].
    pub fn history(&self, after: Tick) -> Result<Vec<Headers>, ReadError> {
        let ports = self.ports.as_ref().ok_or(ReadError::Busy)?;
        let (last, _) = ports.readers.executive.read()?;
        Ok(ports.readers.history.read(after, last)?)
    }

    /// The view of the simulated cell; `None` before its first tick, or if the run has no simulated cell. It is
    /// published after the tick whose number it has, so it may be a tick behind [`Self::memory`].
    ///
    /// # Errors
    /// [`ReadError`].
    pub fn cell(&self) -> Result<Option<CellView>, ReadError> {
        let ports = self.ports.as_ref().ok_or(ReadError::Busy)?;
        let (_, view) = ports.readers.cell.read()?;
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
