//! Assigns each point to an output or a sensor of the devices.

use interfaces::point::Station;

use super::{DeviceError, Devices, Machine, Programs};
use crate::{CellDescription, WorkstationAction, vise::Jaws};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Output {
    Vise(Jaws),
    ViseProgram,
    Start(usize),
    MachineProgram(usize),
    Grip,
    Release,
    Tool,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Sensor {
    Vise(Jaws),
    ViseProgram,
    Ready(usize),
    Busy(usize),
    Done(usize),
    Fault(usize),
    Clear(usize),
    Gripped,
    Released,
    Tool,
    Tray(String, u16),
    Air,
    Safety,
    None, // an input of the controller's own records
}

impl Devices {
    pub(super) fn output(
        &mut self,
        name: &str,
        point: &Station<'_>,
        cell: &CellDescription,
    ) -> Result<Output, DeviceError> {
        let (device, last) = ends(name);
        Ok(match (device, last) {
            ("vise", "open") => self.vise_at(name, point, cell).map(|()| Output::Vise(Jaws::Open))?,
            ("vise", "partial") => self.vise_at(name, point, cell).map(|()| Output::Vise(Jaws::Partial))?,
            ("vise", "close") => self.vise_at(name, point, cell).map(|()| Output::Vise(Jaws::Closed))?,
            ("vise", _) => self.vise_at(name, point, cell).map(|()| Output::ViseProgram)?,
            ("machine", "start") => Output::Start(self.machine_at(name, point, cell)?),
            ("machine", _) => Output::MachineProgram(self.machine_at(name, point, cell)?),
            (_, "grip") => Output::Grip,
            (_, "release") => Output::Release,
            _ => Output::Tool,
        })
    }

    pub(super) fn sensor(
        &mut self,
        name: &str,
        point: &Station<'_>,
        cell: &CellDescription,
    ) -> Result<Sensor, DeviceError> {
        let (device, last) = ends(name);
        Ok(match (device, last) {
            ("vise", "opened") => self.vise_at(name, point, cell).map(|()| Sensor::Vise(Jaws::Open))?,
            ("vise", "partial") => self.vise_at(name, point, cell).map(|()| Sensor::Vise(Jaws::Partial))?,
            ("vise", "clamped") => self.vise_at(name, point, cell).map(|()| Sensor::Vise(Jaws::Closed))?,
            ("vise", _) => self.vise_at(name, point, cell).map(|()| Sensor::ViseProgram)?,
            ("machine", "ready") => Sensor::Ready(self.machine_at(name, point, cell)?),
            ("machine", "busy") => Sensor::Busy(self.machine_at(name, point, cell)?),
            ("machine", "done") => Sensor::Done(self.machine_at(name, point, cell)?),
            ("machine", "fault") => Sensor::Fault(self.machine_at(name, point, cell)?),
            ("machine", _) => Sensor::Clear(self.machine_at(name, point, cell)?),
            ("tray", _) => tray_at(name, point, cell)?,
            ("drum", "gripped") => Sensor::Gripped,
            ("drum", "released") => Sensor::Released,
            ("drum", _) => Sensor::Tool,
            ("air", _) => Sensor::Air,
            _ => Sensor::Safety,
        })
    }

    fn vise_at(&self, name: &str, point: &Station<'_>, cell: &CellDescription) -> Result<(), DeviceError> {
        cell.has_vise_at(point.place).map_err(|_| DeviceError::NoDevice {
            point: name.to_owned(),
            expected: format!("its vise at {}", cell.vise.location),
        })
    }

    fn machine_at(
        &mut self,
        name: &str,
        point: &Station<'_>,
        cell: &CellDescription,
    ) -> Result<usize, DeviceError> {
        if let Some(index) = self.machines.iter().position(|machine| machine.location == point.place) {
            return Ok(index);
        }
        let known = cell.machine_at(point.place, "");
        known
            .map_err(|error| DeviceError::NoDevice { point: name.to_owned(), expected: error.to_string() })?;
        self.machines.push(Machine { location: point.place.to_owned(), ..Machine::default() });
        Ok(self.machines.len() - 1)
    }
}

fn ends(name: &str) -> (&str, &str) {
    let first = name.split('.').next().unwrap_or_default();
    (first, name.rsplit('.').next().unwrap_or_default())
}

fn tray_at(name: &str, point: &Station<'_>, cell: &CellDescription) -> Result<Sensor, DeviceError> {
    let place = point.place.split_once('.').and_then(|(unit, sector)| Some((unit, sector.parse().ok()?)));
    let there = place.filter(|(unit, sector)| {
        let tray = cell.tray(unit).is_some_and(|tray| tray.sector(*sector).is_some());
        tray || cell.nest.iter().any(|nest| nest.location == *unit && nest.sector == *sector)
    });
    there.map(|(unit, sector)| Sensor::Tray(unit.to_owned(), sector)).ok_or_else(|| {
        let units = cell.tray.iter().map(|tray| format!("{} with {} sectors", tray.unit, tray.sectors.len()));
        DeviceError::NoDevice { point: name.to_owned(), expected: units.collect::<Vec<_>>().join(", ") }
    })
}

pub(super) fn check(programs: &Programs, cell: &CellDescription) -> Result<(), DeviceError> {
    let vise = programs
        .vise
        .iter()
        .map(|(number, name)| (*number, WorkstationAction::ViseProgram { name: name.clone() }));
    let machine = programs.machine.iter().map(|(number, [location, from, to])| {
        let (location, from, to) = (location.clone(), from.clone(), to.clone());
        (*number, WorkstationAction::Machine { from, to, location })
    });
    let drum = programs
        .drum
        .iter()
        .map(|(number, part)| (*number, WorkstationAction::DrumTool { part: part.clone() }));
    for (number, action) in vise.chain(machine).chain(drum) {
        let admitted = cell.admits(&action);
        admitted.map_err(|error| DeviceError::Program { number, why: error.to_string() })?;
    }
    Ok(())
}
