//! A ladder whose processes can be lost.

use std::convert::Infallible;

use crate::course::Levels;
use interfaces::{CommonMemory, ExternalInputs};
use levels::ladder::{Ladder, ProcessId};
use rcs_core::tick::Tick;
use taskdata::files::TaskData;

/// The control processes on one board. A lost process writes nothing, so its stamp does not advance.
#[derive(Clone)]
pub struct Present {
    ladder: Ladder,
    processes: Vec<ProcessId>,
}

impl Default for Present {
    fn default() -> Self {
        Self { ladder: Ladder::default(), processes: ProcessId::ALL.to_vec() }
    }
}

impl Present {
    #[must_use]
    pub const fn ladder(&self) -> &Ladder {
        &self.ladder
    }

    #[must_use]
    pub fn processes(&self) -> &[ProcessId] {
        &self.processes
    }

    pub fn restart(&mut self, process: ProcessId) {
        self.ladder.restart(process);
    }

    /// Switch the controller off: no process runs, and [`ClosedLoop::outputs`](crate::ClosedLoop::outputs) are zero.
    pub fn switch_off(&mut self) {
        self.processes.clear();
    }

    /// All processes start without state and adopt the buffers in common memory (see `ClosedLoop::resume`).
    pub fn switch_on(&mut self) {
        self.processes = ProcessId::ALL.to_vec();
        for process in ProcessId::ALL.iter().copied() {
            self.ladder.restart(process);
        }
    }

    /// Lose a process: it writes no outputs from now on.
    pub fn lose(&mut self, process: ProcessId) {
        self.processes.retain(|present| *present != process);
    }
}

impl Levels<TaskData<'_>> for Present {
    type Error = Infallible;

    fn step(
        &mut self,
        tick: Tick,
        before: &CommonMemory,
        external: &ExternalInputs,
        data: &TaskData<'_>,
        after: &mut CommonMemory,
        observe: &mut dyn FnMut(Option<ProcessId>),
    ) -> Result<(), Infallible> {
        self.ladder.step_observed(&self.processes, tick, before, external, data, after, observe);
        Ok(())
    }

    fn shadow(&self) -> Option<Box<Self>> {
        Some(Box::new(self.clone()))
    }

    fn copy_to(&self, shadow: &mut Self) {
        shadow.ladder.clone_from(&self.ladder);
        shadow.processes.clone_from(&self.processes);
    }
}
