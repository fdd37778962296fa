//! The outputs of a resumed run (docs/design/field.md "Resume").
//!
//! Until the first command the devices keep the outputs that were read back. An output that is on must be one that the
//! earlier run has set and that may be on at rest.

use couplers::OutWords;
use interfaces::{CommonMemory, PROCESS_COUNT, ProcessId};

/// Outputs of the devices at the start of a resumed run, by the names of their points.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FoundOutputs {
    /// On, may be on at rest, and set by the earlier run: they stay on.
    pub adopted: Vec<String>,
    /// Set by the earlier run, and off.
    pub cleared: Vec<String>,
    /// On, and not set by the earlier run; with the index of the device.
    pub unknown: Vec<(usize, String)>,
}

/// Images that the devices keep until a process gets a command.
#[derive(Clone, Debug)]
pub(super) struct Hold {
    images: Vec<OutWords>,
    numbers: CommandNumbers,
}

type CommandNumbers = [u32; PROCESS_COUNT];

/// The robot's link has no outputs behind couplers, and starts by itself.
fn command_numbers(memory: &CommonMemory) -> CommandNumbers {
    let mut numbers = [0; PROCESS_COUNT];
    for (number, process) in numbers.iter_mut().zip(ProcessId::ALL) {
        let is_link = *process == ProcessId::T3i;
        *number = memory.command_number(*process).filter(|_| !is_link).unwrap_or_default();
    }
    numbers
}

impl Hold {
    pub(super) fn new(images: Vec<OutWords>, memory: &CommonMemory) -> Self {
        Self { images, numbers: command_numbers(memory) }
    }

    pub(super) fn images(&self) -> &[OutWords] {
        &self.images
    }

    pub(super) fn ends(&self, memory: &CommonMemory) -> bool {
        command_numbers(memory) != self.numbers
    }
}
