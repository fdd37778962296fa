//! The workstation with the ideal cell, in which every action succeeds.

use interfaces::DeviceInputs;
use neighbours::workstation::player::Workstation;
use plant::Ideal;
use taskdata::load::job::Workstation as Action;

use crate::{Turn, World, workstation::orders};

#[derive(Clone, Debug)]
pub struct IdealWorkstation {
    pub cell: Ideal,
    loads: Vec<u32>,
}

impl IdealWorkstation {
    #[must_use]
    pub const fn new(cell: Ideal) -> Self {
        Self { cell, loads: Vec::new() }
    }
}

impl Workstation for IdealWorkstation {
    fn begin(&mut self, action: &Action, _: &str) -> Result<(), String> {
        if let Action::Load { number } = action {
            self.loads.push(*number);
        }
        let orders = orders(action, self.cell.description()).map_err(|error| error.to_string())?;
        orders.iter().try_for_each(|order| self.cell.workstation(order)).map_err(|error| error.to_string())
    }

    fn busy(&self) -> bool {
        self.cell.workstation_busy()
    }

    fn fault(&self) -> Option<String> {
        None
    }
}

impl World for IdealWorkstation {
    type Checks = ();
    type Settled = ();

    fn checks(&self) {}

    fn inputs(&self) -> DeviceInputs {
        self.cell.inputs()
    }

    fn settle(&mut self, (): &mut (), turn: &Turn<'_>) -> (DeviceInputs, ()) {
        (self.cell.step(turn.outputs), ())
    }

    fn loads(&mut self) -> Vec<u32> {
        std::mem::take(&mut self.loads)
    }
}
