//! The workstation of the simulated cell, as the workstation controller's emulator sees it.

use executive::hwsc::Workstation;
use plant::{BoxAction, BoxButton, Cell, CellEvent, Placement, WorkstationAction};
use rcs_core::interface::device::{joystick_frame, single_step};
use taskdata::load::job::{
    Drum, Joystick, JoystickButton, JoystickFrame, Offset, Stepped, ViseOpening, Workstation as Action,
};

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

    /// What the cell has to do for an action, in this order.
    fn translate(&self, action: &Action) -> Result<Vec<WorkstationAction>, String> {
        Ok(vec![match action {
            Action::Tray { location, object, offset } => WorkstationAction::Place {
                part: object.to_string(),
                unit: location.name.to_string(),
                sector: u16::try_from(location.sector)
                    .map_err(|_| format!("{} is no sector", location.sector))?,
                placement: offset.as_ref().map_or(Placement::Random, placement),
            },
            Action::Vise { opening, location, program } => {
                self.at_vise(location.name.as_str())?;
                let opening = match opening {
                    ViseOpening::Partial => WorkstationAction::VisePartial,
                    ViseOpening::Close => WorkstationAction::ViseClose,
                    ViseOpening::Open => WorkstationAction::ViseOpen,
                };
                let program = program.map(|name| WorkstationAction::ViseProgram { name: name.to_string() });
                return Ok(program.into_iter().chain([opening]).collect());
            }
            Action::Machine { blank, part, location } => WorkstationAction::Machine {
                from: blank.to_string(),
                to: part.to_string(),
                location: location.name.to_string(),
            },
            Action::Drum(Drum::Grip) => WorkstationAction::DrumGrip,
            Action::Drum(Drum::Release) => WorkstationAction::DrumRelease,
            Action::Drum(Drum::Tool(tool)) => WorkstationAction::DrumTool { part: tool.to_string() },
            Action::Joystick(action) => WorkstationAction::Joystick(at_the_box(*action)),
            // The emulator of the workstation controller counts the ticks itself.
            Action::Wait { .. } => return Ok(Vec::new()),
        }])
    }
}

/// The words of a job are those of a person, the box has switches.
const fn at_the_box(action: Joystick) -> BoxAction {
    match action {
        Joystick::Frame(frame) => BoxAction::Frame(match frame {
            JoystickFrame::World => joystick_frame::WORLD,
            JoystickFrame::Tool => joystick_frame::TOOL,
            JoystickFrame::ToolOrigin => joystick_frame::TOOL_ORIGIN,
            JoystickFrame::WristOrigin => joystick_frame::WRIST_ORIGIN,
            JoystickFrame::Off => 0,
        }),
        Joystick::Stick { x, y, ticks } => BoxAction::Stick { x, y, ticks },
        Joystick::Press { button, ticks } => BoxAction::Press(
            match button {
                JoystickButton::Up => BoxButton::Up,
                JoystickButton::Down => BoxButton::Down,
                JoystickButton::RollPlus => BoxButton::RollPlus,
                JoystickButton::RollMinus => BoxButton::RollMinus,
                JoystickButton::Open => BoxButton::Open,
                JoystickButton::Close => BoxButton::Close,
            },
            ticks,
        ),
        Joystick::Velocity(knob) => BoxAction::Velocity(knob),
        Joystick::Record => BoxAction::Record,
        Joystick::Resume => BoxAction::Resume,
        Joystick::Hold(process) => BoxAction::Hold(switch(process)),
        Joystick::Free(process) => BoxAction::Free(switch(process)),
        Joystick::Step { process, count } => BoxAction::Step(switch(process), count),
    }
}

const fn switch(process: Stepped) -> u8 {
    match process {
        Stepped::Task => single_step::TASK,
        Stepped::Subtask => single_step::SUBTASK,
        Stepped::Emove => single_step::EMOVE,
        Stepped::Prim => single_step::PRIM,
    }
}

/// Jobs are written in hundredths, the cell has inches and degrees.
fn placement(offset: &Offset) -> Placement {
    let hundredths = |value: i32| f64::from(value) / 100.0;
    Placement::At { x: hundredths(offset.x), y: hundredths(offset.y), angle: hundredths(offset.angle) }
}

impl Workstation for SimulatedWorkstation {
    fn begin(&mut self, action: &Action) -> Result<(), String> {
        for action in self.translate(action)? {
            self.cell.workstation(&action).map_err(|error| error.to_string())?;
        }
        Ok(())
    }

    fn busy(&self) -> bool {
        self.cell.workstation_busy()
    }

    fn fault(&self) -> Option<String> {
        self.fault.clone()
    }
}
