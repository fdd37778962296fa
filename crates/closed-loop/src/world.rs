//! The interface of a cell to the controller.

use depc::Plate;
use interfaces::{CommonMemory, DeviceInputs, DeviceOutputs, HwsCommand};
use neighbours::workstation::player::Workstation;
use rcs_core::tick::Tick;
use taskdata::files::TaskData;

/// A cell with the other equipment of its workstation, and its judges.
pub trait World: Workstation {
    type Checks: Clone;
    type Settled;

    /// Judges without history.
    fn checks(&self) -> Self::Checks;

    fn inputs(&self) -> DeviceInputs;

    /// Advance by a tick and judge it. Also returns the device words of the next tick.
    fn settle(&mut self, checks: &mut Self::Checks, turn: &Turn<'_>) -> (DeviceInputs, Self::Settled);

    /// Reloads of task data that the job has requested since the last call.
    fn loads(&mut self) -> Vec<u32>;
}

/// A tick whose processes have run.
#[derive(Clone, Copy, Debug)]
pub struct Turn<'a> {
    pub tick: Tick,
    pub hws: &'a HwsCommand,
    pub memory: &'a CommonMemory,
    pub data: &'a TaskData<'a>,
    pub outputs: &'a DeviceOutputs,
    /// Position of an external robot, as far as known.
    pub moved: Option<&'a Plate>,
}
