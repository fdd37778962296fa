//! The workstation of the simulated cell, as the workstation controller's emulator sees it.

use executive::hwsc::Workstation;
use plant::{Cell, CellEvent, Placement, WorkstationAction};
use taskdata::load::job::{Offset, ViseOpening, Workstation as Action};

/// The cell, with what went wrong in it.
pub struct SimulatedWorkstation {
    /// The cell.
    pub cell: Cell,
    vise: String,
    fault: Option<String>,
}

impl SimulatedWorkstation {
    /// A workstation around a cell whose vise stands at `vise`.
    pub const fn new(cell: Cell, vise: String) -> Self {
        Self { cell, vise, fault: None }
    }

    /// What happened in the cell since the last call. A simulation that has failed is a fault of the
    /// workstation.
    pub fn events(&mut self) -> Vec<CellEvent> {
        let events = self.cell.events();
        if let Some(event) = events.iter().find(|event| **event == CellEvent::Quarantined) {
            self.fault = Some(event.to_string());
        }
        events
    }

    /// The cell has one vise.
    fn at_vise(&self, location: &str) -> Result<(), String> {
        if location == self.vise {
            Ok(())
        } else {
            Err(format!("there is no vise at {location}; the cell has one at {}", self.vise))
        }
    }

    fn translate(&self, action: &Action) -> Result<WorkstationAction, String> {
        Ok(match action {
            Action::Tray { location, object, offset } => WorkstationAction::Place {
                part: object.to_string(),
                unit: location.name.to_string(),
                sector: u16::try_from(location.sector)
                    .map_err(|_| format!("{} is no sector", location.sector))?,
                placement: offset.as_ref().map_or(Placement::Random, placement),
            },
            Action::Vise { opening, location } => {
                self.at_vise(location.name.as_str())?;
                match opening {
                    ViseOpening::Partial => WorkstationAction::VisePartial,
                    ViseOpening::Close => WorkstationAction::ViseClose,
                    ViseOpening::Open => WorkstationAction::ViseOpen,
                }
            }
            Action::Machine { blank, part, location } => {
                self.at_vise(location.name.as_str())?;
                WorkstationAction::Machine { from: blank.to_string(), to: part.to_string() }
            }
        })
    }
}

/// Jobs are written in hundredths, the cell has inches and degrees.
fn placement(offset: &Offset) -> Placement {
    let hundredths = |value: i32| f64::from(value) / 100.0;
    Placement::At { x: hundredths(offset.x), y: hundredths(offset.y), angle: hundredths(offset.angle) }
}

impl Workstation for SimulatedWorkstation {
    fn begin(&mut self, action: &Action) -> Result<(), String> {
        let action = self.translate(action)?;
        self.cell.workstation(&action).map_err(|error| error.to_string())
    }

    fn busy(&self) -> bool {
        self.cell.workstation_busy()
    }

    fn fault(&self) -> Option<String> {
        self.fault.clone()
    }
}
