//! The side of the run: creates all services before the first tick and writes them once a tick, without
//! allocating.

use std::sync::{Arc, Mutex, TryLockError};

use interfaces::{CommonMemory, ExternalInputs};

use super::{
    buffers::Writers,
    cell::CellView,
    error::SharedMemoryError,
    layout::{Epoch, Pulse},
    name::RunName,
    place, runs,
};

/// The role of the program that shows a run.
pub(crate) const PUBLISHER: &str = "rcs-run";

/// Epoch of a run whose writers were never restarted.
pub const FIRST_EPOCH: Epoch = 1;

/// What was published last.
#[derive(Clone, Copy, Default)]
pub(super) struct Published {
    pub external: ExternalInputs,
    pub memory: CommonMemory,
    pub pulse: Pulse,
}

/// What was published last, for other threads of this program: no other process can change it. Neither side waits for
/// the other, so that a reading thread never delays a tick.
#[derive(Default)]
pub(super) struct Window(Mutex<Published>);

impl Window {
    /// Run `work` on the copy; `None` while the other side uses it.
    pub(super) fn with<T>(&self, work: impl FnOnce(&mut Published) -> T) -> Option<T> {
        match self.0.try_lock() {
            Ok(mut published) => Some(work(&mut published)),
            // Every value in it is whole whatever its owner was doing when it panicked.
            Err(TryLockError::Poisoned(published)) => Some(work(&mut published.into_inner())),
            Err(TryLockError::WouldBlock) => None,
        }
    }
}

/// The writers of all buffers of a run. Dropping it ends the run in shared memory: readers that are still
/// attached see [`Pulse::over`], and the process that leaves last removes the files.
pub struct Publisher {
    name: RunName,
    // Taken out before the files are removed: iceoryx2 must have let go of them by then.
    ports: Option<Ports>,
    pulse: Pulse,
    window: Arc<Window>,
}

struct Ports {
    writers: Writers,
    // Last: the services are closed before their node.
    _member: runs::RunNode,
}

impl Publisher {
    /// Set up all services of a run. The remains of killed runs are removed first.
    ///
    /// # Errors
    /// [`SharedMemoryError`] with what iceoryx2 says, if there is not enough shared memory or the name is taken.
    pub fn create(name: &RunName) -> Result<Self, SharedMemoryError> {
        // Half a run is none: what was set up before something failed goes again.
        Self::set_up(name).inspect_err(|_| {
            let _ = runs::remove_if_deserted(name, &place::layout());
        })
    }

    fn set_up(name: &RunName) -> Result<Self, SharedMemoryError> {
        runs::clean()?;
        place::have_room()?;
        let member = runs::enter(name, PUBLISHER)?;
        let ports = Ports { writers: Writers::create(&member, FIRST_EPOCH)?, _member: member };
        place::reserve(name)?;
        Ok(Self { name: name.clone(), ports: Some(ports), pulse: Pulse::default(), window: Arc::default() })
    }

    pub(super) fn window(&self) -> Arc<Window> {
        Arc::clone(&self.window)
    }

    /// The name under which readers find the run.
    #[must_use]
    pub const fn name(&self) -> &RunName {
        &self.name
    }

    /// Write the buffers of a tick: what came in, what the processes wrote, and the pulse, in this order.
    /// Does not allocate.
    pub fn publish(&mut self, external: &ExternalInputs, memory: &CommonMemory, pulse: Pulse) {
        let Some(ports) = &self.ports else { return };
        ports.writers.write(external, memory, &pulse);
        self.pulse = pulse;
        // If it is being looked at, the next tick comes soon.
        let _ = self.window.with(|seen| *seen = Published { external: *external, memory: *memory, pulse });
    }
}

impl Publisher {
    /// Publish the simulated cell after a tick. Does not allocate.
    pub fn show_cell(&self, view: &CellView) {
        if let Some(ports) = &self.ports {
            ports.writers.cell.write(view);
        }
    }
}

impl Drop for Publisher {
    fn drop(&mut self) {
        if let Some(ports) = self.ports.take() {
            ports.writers.executive.write(&Pulse { over: true, ..self.pulse });
            drop(ports);
        }
        // Nothing can be done about a failure here; `rcs-run clean` tries again and reports.
        let _ = runs::remove_if_deserted(&self.name, &place::layout());
    }
}
