//! Vise, machines, drum and trays as devices behind points: outputs of a controller move them, and sensors show their
//! state. They act on the same vise, parts and drum as [`Cell::workstation`].
//!
//! | device | outputs | behaviour |
//! |---|---|---|
//! | vise | `open`, `partial`, `close`, `program` | bistable: it stays where it is while all three outputs are off |
//! | machine | `start`, `program` | a rising `start` begins a cycle of [`MACHINING_TICKS`], which machines the part |
//! | drum | `grip`, `release`, `tool` | a new number brings the tool of that pocket to the fingers, once |
//! | trays | none | a sensor per sector |
//!
//! The numbers of programs and pockets are those of a [`Programs`], since the cell description has names.

mod bind;

use interfaces::{point::Station, station::EStop};
use rcs_core::tick::TICK_MS;

use self::bind::{Output, Sensor, check};
use super::{Cell, WorkstationAction};
use crate::{CellDescription, vise::Jaws};

/// Duration of a cycle of the machine. CHOSEN: 3 s, so that a job takes little longer than without it.
pub const MACHINING_TICKS: u64 = 3000 / TICK_MS;
/// A machine reports a fault for this time. CHOSEN: 5 s, in which its own operator acknowledges it.
const FAULT_TICKS: u64 = 5000 / TICK_MS;
/// The robot is clear of a machine if its fingertips are farther than this from the part's place, in. CHOSEN: more than
/// a gripper with a part.
const CLEAR: f64 = 20.0;

/// Numbers of programs and pockets, with their names in the cell description.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Programs {
    pub vise: Vec<(i64, String)>,
    pub machine: Vec<(i64, [String; 3])>, // programs of the machines: number, location, blank and part
    pub drum: Vec<(i64, String)>,         // tools in the pockets of the drum
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DeviceError {
    #[error("{point}: the cell description has {expected}")]
    NoDevice { point: String, expected: String },
    #[error("program {number}: {why}")]
    Program { number: i64, why: String },
}

#[derive(Clone, Debug, Default)]
struct Machine {
    location: String,
    start: bool,
    program: i64,
    cycle: Option<(u64, i64)>, // ticks of the cycle that are left, and its program
    done: bool,
    fault: u64, // ticks for which the fault is still reported
}

#[derive(Clone, Debug)]
pub struct Devices {
    programs: Programs,
    outputs: Vec<Option<Output>>,
    sensors: Vec<Sensor>,
    machines: Vec<Machine>,
    vise: Option<(Jaws, i64)>, // the opening and the program that the vise was given last
    vise_program: i64,
    asked: Option<Jaws>,
    fingers: [bool; 2],
    pocket: i64,
    emptied: Vec<i64>, // pockets whose tool was brought to the fingers
    messages: Vec<String>,
    estop: bool, // the emergency stop of the safety circuit is pressed, in addition to those of the robot
}

impl Devices {
    /// Devices for the outputs and inputs in `names`. Names of the controller's own records are permitted, and not
    /// used. Fails for a point or a program that the cell does not have.
    pub fn new<'n>(
        cell: &CellDescription,
        programs: Programs,
        outputs: impl IntoIterator<Item = &'n str>,
        inputs: impl IntoIterator<Item = &'n str>,
    ) -> Result<Self, DeviceError> {
        check(&programs, cell)?;
        let mut devices = Self {
            programs,
            outputs: Vec::new(),
            sensors: Vec::new(),
            machines: Vec::new(),
            vise: None,
            vise_program: 0,
            asked: None,
            fingers: [false; 2],
            pocket: 0,
            emptied: Vec::new(),
            messages: Vec::new(),
            estop: false,
        };
        for name in outputs {
            let output =
                Station::written(name).map(|point| devices.output(name, &point, cell)).transpose()?;
            devices.outputs.push(output);
        }
        for name in inputs {
            let sensor = Station::read(name).map(|point| devices.sensor(name, &point, cell)).transpose()?;
            devices.sensors.push(sensor.unwrap_or(Sensor::None));
        }
        Ok(devices)
    }

    /// Presses the emergency stop of the safety circuit, or releases it. It does not act on the simulated T3.
    pub const fn press_estop(&mut self, pressed: bool) {
        self.estop = pressed;
    }

    pub fn messages(&mut self) -> Vec<String> {
        std::mem::take(&mut self.messages)
    }

    /// Follows the outputs of the controller, one value for each, for a tick. Call it before the cell is advanced.
    pub fn follow(&mut self, cell: &mut Cell, values: &[i64]) {
        let mut outputs: Vec<(Output, i64)> = self
            .outputs
            .iter()
            .zip(values)
            .filter_map(|(output, value)| Some(((*output)?, *value)))
            .collect();
        // A start in the same image as a change of the program starts the new program.
        outputs.sort_by_key(|(output, _)| !matches!(output, Output::ViseProgram | Output::MachineProgram(_)));
        let mut openings = Vec::new();
        for (output, value) in outputs {
            match output {
                Output::Vise(jaws) if value != 0 => openings.push(jaws),
                Output::Vise(_) => {}
                Output::ViseProgram => self.vise_program = value,
                Output::Start(index) => self.start(cell, index, value != 0),
                Output::MachineProgram(index) => {
                    if let Some(machine) = self.machines.get_mut(index) {
                        machine.program = value;
                    }
                }
                Output::Grip => self.finger(cell, 0, value != 0),
                Output::Release => self.finger(cell, 1, value != 0),
                Output::Tool => self.turn_drum(cell, value),
            }
        }
        // Valves that contradict each other move nothing.
        self.asked = if let [jaws] = openings[..] { Some(jaws) } else { None };
        self.move_vise(cell);
        for index in 0..self.machines.len() {
            self.work(cell, index);
        }
    }

    fn move_vise(&mut self, cell: &mut Cell) {
        let Some(jaws) = self.asked else {
            // A person may move the jaws while no valve is on.
            self.vise = None;
            return;
        };
        let asked = (jaws, self.vise_program);
        if self.vise == Some(asked) || cell.vise.moving() {
            return;
        }
        let program = self.programs.vise.iter().find(|(number, _)| *number == asked.1);
        let program = program.map(|(_, name)| WorkstationAction::ViseProgram { name: name.clone() });
        let opening = match jaws {
            Jaws::Open => WorkstationAction::ViseOpen,
            Jaws::Partial => WorkstationAction::VisePartial,
            Jaws::Closed => WorkstationAction::ViseClose,
        };
        match program.iter().chain([&opening]).try_for_each(|action| cell.workstation(action)) {
            Ok(()) => self.vise = Some(asked),
            Err(error) => self.messages.push(error.to_string()),
        }
    }

    fn start(&mut self, cell: &Cell, index: usize, on: bool) {
        let Some(machine) = self.machines.get_mut(index) else { return };
        let rises = !std::mem::replace(&mut machine.start, on) && on;
        if !rises || machine.cycle.is_some() {
            return;
        }
        (machine.done, machine.fault) = (false, 0);
        let known = self
            .programs
            .machine
            .iter()
            .any(|(number, [location, ..])| *number == machine.program && *location == machine.location);
        if known && is_clear(cell, &machine.location) {
            machine.cycle = Some((MACHINING_TICKS, machine.program));
            return;
        }
        machine.fault = FAULT_TICKS;
        let why = if known {
            "the robot is not clear of it".to_owned()
        } else {
            format!("it has no program {}", machine.program)
        };
        self.messages.push(format!("the machine at {} does not start: {why}", machine.location));
    }

    fn work(&mut self, cell: &mut Cell, index: usize) {
        let Some(machine) = self.machines.get_mut(index) else { return };
        machine.fault = machine.fault.saturating_sub(1);
        let Some((left, program)) = machine.cycle else { return };
        let failed = if is_clear(cell, &machine.location) {
            if left > 1 {
                machine.cycle = Some((left - 1, program));
                return;
            }
            let known = self
                .programs
                .machine
                .iter()
                .find(|(number, [location, ..])| *number == program && *location == machine.location);
            known.and_then(|(_, [location, from, to])| {
                let action = WorkstationAction::Machine {
                    from: from.clone(),
                    to: to.clone(),
                    location: location.clone(),
                };
                cell.workstation(&action).err().map(|error| error.to_string())
            })
        } else {
            Some("the robot came near".to_owned())
        };
        machine.cycle = None;
        machine.done = failed.is_none();
        if let Some(why) = failed {
            machine.fault = FAULT_TICKS;
            self.messages.push(format!("the machine at {} stops: {why}", machine.location));
        }
    }

    /// The outputs of the drum's fingers: 0 closes, 1 opens.
    fn finger(&mut self, cell: &mut Cell, index: usize, on: bool) {
        let Some(last) = self.fingers.get_mut(index) else { return };
        let rises = !std::mem::replace(last, on) && on;
        if rises && let Err(error) = cell.set_drum_fingers(index == 0) {
            self.messages.push(error.to_string());
        }
    }

    fn turn_drum(&mut self, cell: &mut Cell, pocket: i64) {
        if std::mem::replace(&mut self.pocket, pocket) == pocket || self.emptied.contains(&pocket) {
            return;
        }
        let Some((_, tool)) = self.programs.drum.iter().find(|(number, _)| *number == pocket) else { return };
        match cell.workstation(&WorkstationAction::DrumTool { part: tool.clone() }) {
            Ok(()) => self.emptied.push(pocket),
            Err(error) => self.messages.push(error.to_string()),
        }
    }

    /// The sensor readings, one value for each input; 0 for inputs of the controller's own records.
    pub fn sense(&self, cell: &Cell, values: &mut Vec<i64>) {
        let parts = if self.sensors.iter().any(|sensor| matches!(sensor, Sensor::Tray(..))) {
            cell.parts()
        } else {
            Vec::new()
        };
        let machine = |index: &usize| self.machines.get(*index);
        values.clear();
        values.extend(self.sensors.iter().map(|sensor| match sensor {
            Sensor::Vise(jaws) => i64::from(cell.vise.resting() == Some(*jaws)),
            Sensor::ViseProgram => {
                let name = cell.vise.program();
                self.programs.vise.iter().find(|(_, known)| known == name).map_or(0, |(number, _)| *number)
            }
            Sensor::Ready(index) => {
                i64::from(machine(index).is_some_and(|machine| machine.cycle.is_none() && machine.fault == 0))
            }
            Sensor::Busy(index) => i64::from(machine(index).is_some_and(|machine| machine.cycle.is_some())),
            Sensor::Done(index) => i64::from(machine(index).is_some_and(|machine| machine.done)),
            Sensor::Fault(index) => i64::from(machine(index).is_some_and(|machine| machine.fault > 0)),
            Sensor::Clear(index) => {
                i64::from(machine(index).is_some_and(|machine| is_clear(cell, &machine.location)))
            }
            Sensor::Gripped => i64::from(cell.drum_closed()),
            Sensor::Released => i64::from(!cell.drum_closed()),
            Sensor::Tool => {
                let tool = parts_name_in_drum(cell);
                let pocket = self.programs.drum.iter().find(|(_, name)| Some(name.as_str()) == tool);
                pocket.map_or(0, |(number, _)| *number)
            }
            Sensor::Tray(unit, sector) => {
                let there =
                    |part: &crate::PartState| !part.held && part.location == *unit && part.sector == *sector;
                i64::from(parts.iter().any(there))
            }
            Sensor::Air => i64::from(!cell.faults.air_lost()),
            Sensor::Safety => i64::from(!EStop::ALL.iter().any(|site| cell.t3().is_pressed(*site))),
            Sensor::None => 0,
        }));
    }
}

fn is_clear(cell: &Cell, location: &str) -> bool {
    let place = match cell.description.machine_at(location, "") {
        Ok(super::order::Machine::Nest(nest)) => nest.frame().position,
        _ => cell.vise.frame().position,
    };
    (cell.tool().position - place).norm() > CLEAR
}

fn parts_name_in_drum(cell: &Cell) -> Option<&str> {
    let pocketed = cell.drum.tool?;
    cell.parts.get(pocketed.part).map(|part| part.kind.name.as_str())
}

#[cfg(test)]
mod tests;
