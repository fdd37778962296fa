//! Couplers in simulated time, between the controller and the simulated cell (`--field sim:NAME`).
//!
//! ```text
//!   tick n   outputs ──► session ──1 ms──► coupler ──► valves of the cell
//!            inputs  ◄── session ◄─32 ms── coupler ◄── sensors of the cell
//! ```
//!
//! Words of mapped groups pass through mapping, session and an emulated coupler with its watchdog. The exchanges take
//! place 1 ms after and 8 ms before a slot, as with a real device, so the couplers add no delay. A fault `field-cut`
//! of the cell cuts the connection of a device.

mod desk;
mod event;
mod hold;
mod without_current;

use std::{ops::Range, sync::Arc};

use couplers::{Emulated, InWords, MS, OutWords, PlanError, Simulated, State};
use field::{Mapping, SAFETY};
use interfaces::{DeviceInputs, DeviceOutputs};
use plant::{
    Cell, CellDescription,
    devices::{DeviceError, Devices},
};
use rcs_core::{
    Plain as _,
    tick::{TICK_MS, Tick},
};

use self::without_current::{Power, fall_back};
pub use self::{
    desk::FieldController,
    event::{FieldChange, FieldEvent},
    hold::FoundOutputs,
};
use crate::devices;

const SET_UP_MS: u64 = 2000; // simulated time before the first tick, for the set-up of the devices, ms
const EXCHANGES_MS: [u64; 2] = [1, TICK_MS - 8]; // times of the two exchanges after a slot, ms
const TIMEOUT_MS: u16 = 6; // answer timeout, ms; also the duration of an exchange over a cut connection
/// Time between two exchanges at the end of a run. All [`ENDING_STEPS`] take longer than the session's time limit.
const ENDING_STEP_MS: usize = 20;
const ENDING_STEPS: usize = 12;

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FieldError {
    #[error("{device}: {source}")]
    Plan { device: String, source: PlanError },
    #[error(transparent)]
    Devices(#[from] DeviceError),
    #[error("{device} is not ready after its set-up")]
    NotReady { device: String },
}

#[derive(Clone, Debug)]
pub enum Field {
    Simulated(SimulatedField), // emulated couplers, in simulated time
    External(FieldController), // couplers outside of the loop, whose owner passes orders and reports on
}

impl Field {
    #[must_use]
    pub const fn desk(&self) -> &FieldController {
        match self {
            Self::Simulated(field) => field.desk(),
            Self::External(desk) => desk,
        }
    }

    pub const fn desk_mut(&mut self) -> &mut FieldController {
        match self {
            Self::Simulated(field) => field.desk_mut(),
            Self::External(desk) => desk,
        }
    }
}

#[derive(Clone, Debug, Default)]
struct Cut {
    by_fault: bool,
    times: Range<u64>, // ns
}

#[derive(Clone, Debug)]
pub struct SimulatedField {
    desk: FieldController,
    simulated: Vec<Simulated>,
    power: Vec<Power>, // of the valves of each device
    /// Cuts of the connection of each device: by a fault of the cell, and by [`cut`](Self::cut).
    cuts: Vec<Cut>,
    now: u64, // time of the last observation, ns: that of the next slot
    /// Vise, machines, drum and trays behind the couplers.
    devices: Option<Box<Devices>>,
    /// The values of the mapping's outputs that arrive at these devices, and those of its inputs from their sensors.
    arrived: Vec<i64>,
    sensed: Vec<i64>,
}

impl SimulatedField {
    /// Set up the devices of a mapping whose sensors show these inputs. Fails if a device cannot be simulated.
    pub fn new(mapping: Arc<Mapping>, inputs: &DeviceInputs) -> Result<Self, FieldError> {
        let simulated = mapping.devices.iter().map(simulated).collect::<Result<_, _>>()?;
        let arrived = vec![0; mapping.outputs.len()];
        // Without devices the safety circuit is closed.
        let sensed = mapping.inputs.iter().map(|point| i64::from(point.name == SAFETY)).collect();
        let cuts = vec![Cut::default(); mapping.devices.len()];
        let power = vec![Power::default(); mapping.devices.len()];
        let desk = FieldController::new(mapping);
        let mut field = Self { desk, simulated, power, cuts, now: 0, devices: None, arrived, sensed };
        field.sense(inputs);
        for tick in 0..SET_UP_MS / TICK_MS {
            for offset in EXCHANGES_MS {
                field.exchange((tick * TICK_MS + offset) * MS);
            }
        }
        field.observe(SET_UP_MS * MS);
        for (report, planned) in field.desk.reports().zip(&field.desk.mapping().devices) {
            if report.state != State::Running {
                return Err(FieldError::NotReady { device: planned.name.clone() });
            }
        }
        field.desk.begin();
        Ok(field)
    }

    /// The couplers of a mapping between the controller and a simulated cell with its devices. Fails if the cell does
    /// not have the devices, or if they cannot be simulated.
    pub fn of_cell(
        mapping: Arc<Mapping>,
        description: &CellDescription,
        cell: &Cell,
    ) -> Result<Self, FieldError> {
        let devices = devices::simulated(&mapping, description)?;
        let mut field = Self::new(mapping, &cell.inputs())?;
        devices.sense(cell, &mut field.sensed);
        field.devices = Some(Box::new(devices));
        Ok(field)
    }

    /// Uses the outputs that have arrived. Call it between [`write`](Self::write) and the tick of the cell.
    pub fn move_devices(&mut self, cell: &mut Cell) {
        let images = self.images();
        self.desk.mapping().spread_station(&images, &mut self.arrived);
        if let Some(devices) = &mut self.devices {
            devices.follow(cell, &self.arrived);
            for message in devices.messages() {
                self.desk.note_message(message);
            }
        }
    }

    /// Read the sensors of the devices. Call it between the tick of the cell and [`read`](Self::read).
    pub fn sense_devices(&mut self, cell: &Cell) {
        if let Some(devices) = &self.devices {
            devices.sense(cell, &mut self.sensed);
        }
    }

    #[must_use]
    pub const fn desk(&self) -> &FieldController {
        &self.desk
    }

    pub const fn desk_mut(&mut self) -> &mut FieldController {
        &mut self.desk
    }

    /// Cuts the connection of a device for `ms`, from `after_ms` after the next slot on. Returns false for an unknown
    /// name.
    pub fn cut(&mut self, name: &str, after_ms: u64, ms: u64) -> bool {
        let from = self.now.saturating_add(after_ms * MS);
        let cut = self.desk.mapping().device(name).and_then(|device| self.cuts.get_mut(device));
        cut.map(|cut| cut.times = from..from.saturating_add(ms * MS)).is_some()
    }

    /// The outputs of the couplers as they are now, in the order of the devices.
    #[must_use]
    pub fn images(&self) -> Vec<OutWords> {
        let devices = &self.desk.mapping().devices;
        let couplers = self.simulated.iter().zip(devices);
        couplers.map(|(simulated, planned)| simulated.coupler().image(&planned.plan)).collect()
    }

    /// The outputs of a tick as they arrive at the valves. `is_cut` is true for devices without a connection.
    pub fn write(
        &mut self,
        tick: Tick,
        outputs: &DeviceOutputs,
        is_cut: impl Fn(&str) -> bool,
    ) -> DeviceOutputs {
        let slot = SET_UP_MS + tick.0.saturating_mul(TICK_MS);
        self.desk.order(tick, outputs);
        for (cut, planned) in self.cuts.iter_mut().zip(&self.desk.mapping().devices) {
            cut.by_fault = is_cut(&planned.name);
        }
        self.exchange((slot + EXCHANGES_MS[0]) * MS);
        let mut arriving = *outputs;
        self.desk.mapping().spread(&self.images(), &mut arriving);
        for (power, simulated) in self.power.iter_mut().zip(&self.simulated) {
            power.note(simulated.coupler(), simulated.report());
        }
        fall_back(self.desk.mapping(), &self.power, &mut arriving);
        arriving
    }

    /// The inputs of the next tick, from the sensors after `tick`.
    pub fn read(&mut self, tick: Tick, inputs: &DeviceInputs) -> DeviceInputs {
        let slot = SET_UP_MS + tick.0.saturating_mul(TICK_MS);
        self.sense(inputs);
        self.exchange((slot + EXCHANGES_MS[1]) * MS);
        self.observe((slot + TICK_MS) * MS);
        let mut arrived = *inputs;
        self.desk.apply(&mut arrived);
        self.desk.note_changes(&arrived);
        arrived
    }

    /// Ends the couplers: each device gets the final outputs, which are then read back, unless it does not answer.
    /// `inputs` are the last ones of the controller.
    pub fn end(&mut self, inputs: &DeviceInputs) {
        self.desk.end();
        for time in (self.now / MS + 1..).step_by(ENDING_STEP_MS).take(ENDING_STEPS) {
            self.exchange(time * MS);
        }
        self.observe(self.now);
        self.desk.note_changes(inputs);
    }

    fn sense(&mut self, inputs: &DeviceInputs) {
        let mapping = self.desk.mapping();
        let mut images = vec![InWords::ZERO; self.simulated.len()];
        mapping.sample(inputs, &mut images);
        mapping.sample_station(&self.sensed, &mut images);
        for ((simulated, image), planned) in self.simulated.iter_mut().zip(images).zip(&mapping.devices) {
            simulated.coupler_mut().show(&planned.plan, &image);
        }
    }

    fn exchange(&mut self, now: u64) {
        let cuts = self.cuts.iter().map(|cut| cut.by_fault || cut.times.contains(&now));
        for ((simulated, orders), is_cut) in self.simulated.iter_mut().zip(self.desk.orders()).zip(cuts) {
            simulated.cut(is_cut);
            simulated.exchange(now, orders);
        }
    }

    fn observe(&mut self, now: u64) {
        self.now = now;
        self.desk.observe(now, self.simulated.iter().map(|simulated| *simulated.report()));
    }
}

fn simulated(planned: &field::Device) -> Result<Simulated, FieldError> {
    let plan = &planned.plan;
    Simulated::new(plan.clone(), Emulated::of(plan), TIMEOUT_MS)
        .map_err(|source| FieldError::Plan { device: planned.name.clone(), source })
}

#[cfg(test)]
mod tests;
