//! Who commands the run: the workstation controller of another process, or an operator who takes over from it.

use interfaces::CommonMemory;
use neighbours::workstation::Gate;
use rcs_core::tick::Tick;
use sessions::network::{EndpointHandle, Role};
use taskdata::load::BlockNumber;

use super::{Neighbours, WorkstationSource};
use crate::{event::Event, outside::OutsideWorkstation};

impl Neighbours {
    #[must_use]
    pub fn is_stand_alone(&self) -> bool {
        matches!(&self.workstation, WorkstationSource::Outside(commanded) if commanded.is_stand_alone())
    }

    fn outside(&mut self) -> Option<&mut OutsideWorkstation> {
        match &mut self.workstation {
            WorkstationSource::Emulator(_) => None,
            WorkstationSource::Outside(commanded) => Some(&mut commanded.outside),
            WorkstationSource::Switched(switched) => Some(switched.outside()),
        }
    }

    /// The block that the workstation controller has requested in this tick, and the line of the request.
    pub fn load_asked(&mut self) -> Option<(BlockNumber, String)> {
        self.outside()?.load_asked()
    }

    /// Answer the load with the reason of a refusal, or `None`.
    pub fn load_answered(&mut self, refused: Option<String>) {
        if let Some(why) = &refused {
            self.events.push(Event::CellLineRefused(why.clone()));
        }
        if let Some(outside) = self.outside() {
            outside.load_answered(refused);
        }
    }

    /// `now` also permits it in the middle of a command. Errors: the reason, as a sentence.
    pub fn take_command(
        &mut self,
        tick: Tick,
        memory: &CommonMemory,
        gate: &mut Gate,
        now: bool,
    ) -> Result<String, String> {
        match &mut self.workstation {
            WorkstationSource::Outside(commanded) => commanded.take_command(tick, &memory.task, gate, now),
            WorkstationSource::Emulator(_) => Err("no workstation controller commands this run".to_owned()),
            WorkstationSource::Switched(_) => {
                Err("the job commands when the workstation controller disconnects (IV.4.1)".to_owned())
            }
        }
    }

    /// Return the command (IV.4.1). Errors: the reason, as a sentence.
    pub fn give_command(
        &mut self,
        tick: Tick,
        memory: &CommonMemory,
        gate: &mut Gate,
    ) -> Result<String, String> {
        let mut data_system = self.network.iter().flat_map(|network| &network.handles);
        let has_data_system = data_system
            .by_ref()
            .filter(|handle| handle.role() == Role::DataSystem)
            .all(EndpointHandle::is_connected);
        match &mut self.workstation {
            WorkstationSource::Outside(commanded) => {
                commanded.give_command(tick, memory, has_data_system, gate)
            }
            WorkstationSource::Emulator(_) => {
                Err("no workstation controller can connect to this run: --outside workstation".to_owned())
            }
            WorkstationSource::Switched(_) => {
                Err("a line ** workstation of the job hands over (IV.4.1)".to_owned())
            }
        }
    }
}
