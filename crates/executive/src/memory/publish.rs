//! The writer's side: creates all services before the first tick and writes them once per tick, without allocating.

use std::sync::{Arc, Mutex, TryLockError};

use interfaces::{CommonMemory, ExternalInputs};

use super::{
    buffers::Writers,
    cell::CellView,
    error::SharedMemoryError,
    field::FieldView,
    layout::{Epoch, Pulse},
    name::RunName,
    place, runs,
};

pub(crate) const PUBLISHER: &str = "rcs-run";

/// Epoch of a run whose writers were never restarted.
pub const FIRST_EPOCH: Epoch = 1;

#[derive(Clone, Copy, Default)]
pub(super) struct Published {
    pub external: ExternalInputs,
    pub memory: CommonMemory,
    pub pulse: Pulse,
}

/// The data published last, for other threads of this program. A reading thread never delays a tick.
#[derive(Default)]
pub(super) struct Window(Mutex<Published>);

impl Window {
    /// Run `work` on the copy; `None` while the other side uses it.
    pub(super) fn with<T>(&self, work: impl FnOnce(&mut Published) -> T) -> Option<T> {
        match self.0.try_lock() {
            Ok(mut published) => Some(work(&mut published)),
            // Every value in it is valid, no matter where its owner panicked.
            Err(TryLockError::Poisoned(published)) => Some(work(&mut published.into_inner())),
            Err(TryLockError::WouldBlock) => None,
        }
    }
}

/// Dropping this ends the run in shared memory: attached readers see [`Pulse::over`], and the last process to leave
/// removes the files.
pub struct Publisher {
    name: RunName,
    ports: Option<Ports>,
    pulse: Pulse,
    window: Arc<Window>,
}

struct Ports {
    writers: Writers,
    _member: runs::RunNode,
}

impl Publisher {
    /// Set up all services of a run, after removing the remains of killed runs.
    pub fn create(name: &RunName) -> Result<Self, SharedMemoryError> {
        // If a step of the set-up fails, remove the objects of the earlier steps.
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

    #[must_use]
    pub const fn name(&self) -> &RunName {
        &self.name
    }

    /// Write the buffers of a tick in this order: external inputs, outputs of the processes, pulse. Does not allocate.
    pub fn publish(&mut self, external: &ExternalInputs, memory: &CommonMemory, pulse: Pulse) {
        let Some(ports) = &mut self.ports else { return };
        ports.writers.write(external, memory, &pulse);
        self.pulse = pulse;
    }

    /// Write the buffers of the last tick once more. Does not allocate.
    pub fn publish_again(&mut self, external: &ExternalInputs, memory: &CommonMemory) {
        self.publish(external, memory, self.pulse);
    }

    /// Copy what was published for the other threads of this program. Does not allocate.
    pub fn show(&self, external: &ExternalInputs, memory: &CommonMemory) {
        let pulse = self.pulse;
        // If the other thread is reading the copy, the next tick updates it soon.
        let _ = self.window.with(|seen| *seen = Published { external: *external, memory: *memory, pulse });
    }
}

impl Publisher {
    /// Publish the simulated cell after a tick. Does not allocate.
    pub fn show_cell(&mut self, view: &CellView) {
        if let Some(ports) = &mut self.ports {
            ports.writers.cell.write(view.tick, view);
        }
    }

    /// Publish the couplers after a tick. Does not allocate.
    pub fn show_field(&mut self, view: &FieldView) {
        if let Some(ports) = &mut self.ports {
            ports.writers.field.write(view.tick, view);
        }
    }
}

impl Drop for Publisher {
    fn drop(&mut self) {
        if let Some(mut ports) = self.ports.take() {
            ports.writers.executive.write(self.pulse.tick, &Pulse { over: true, ..self.pulse });
            drop(ports);
        }
        let _ = runs::remove_if_deserted(&self.name, &place::layout());
    }
}
