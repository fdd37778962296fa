//! Couplers in simulated time, between the controller and the simulated cell (`--field sim:NAME`).
//!
//! ```text
//!   tick n   outputs ──► session ──1 ms──► coupler ──► valves of the cell
//!            inputs  ◄── session ◄─32 ms── coupler ◄── sensors of the cell
//! ```
//!
//! All words of mapped groups pass through mapping, session and an emulated coupler with its watchdog; other words
//! bypass them. The exchanges take place 1 ms after and 8 ms before a slot, as with a real device, so the couplers
//! add no delay. A fault `field-cut` of the cell cuts the connection of a device.

mod desk;
mod event;

use std::sync::Arc;

use couplers::{Emulated, InWords, MS, OutWords, PlanError, Simulated, State};
use field::Mapping;
use interfaces::{DeviceInputs, DeviceOutputs};
use rcs_core::{
    Plain as _,
    tick::{TICK_MS, Tick},
};

pub use self::{
    desk::Desk,
    event::{FieldEvent, Happened},
};

/// Simulated time before the first tick, for the set-up of the devices, ms.
const SET_UP_MS: u64 = 2000;
/// Times of the two exchanges after a slot, ms.
const EXCHANGES_MS: [u64; 2] = [1, TICK_MS - 8];
/// Answer timeout, ms; also the duration of an exchange over a cut connection.
const TIMEOUT_MS: u16 = 6;
/// Times at which the outputs of the end are written and read back: longer than the time limit of a session.
const ENDING_STEP_MS: usize = 20;
const ENDING_STEPS: usize = 12;
/// Registers of an emulated coupler in each direction.
const WORDS: usize = 256;
/// First register of the outputs of an emulated coupler.
const OUTPUTS: usize = 0x0800;

#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FieldError {
    /// The mapping is invalid for this device.
    #[error("{device}: {source}")]
    Plan { device: String, source: PlanError },
    /// Only couplers with process data are emulated.
    #[error("{device}: only devices of the kind bk9000 with registers can be simulated")]
    NotEmulated { device: String },
    #[error("{device} is not ready after its set-up")]
    NotReady { device: String },
}

/// The couplers of a run.
#[derive(Clone, Debug)]
pub enum Field {
    /// Emulated couplers, in simulated time.
    Simulated(SimulatedField),
    /// Couplers outside of the loop, whose owner passes orders and reports on.
    External(Desk),
}

impl Field {
    #[must_use]
    pub const fn desk(&self) -> &Desk {
        match self {
            Self::Simulated(field) => &field.desk,
            Self::External(desk) => desk,
        }
    }

    pub const fn desk_mut(&mut self) -> &mut Desk {
        match self {
            Self::Simulated(field) => &mut field.desk,
            Self::External(desk) => desk,
        }
    }
}

/// The couplers of a mapping, in simulated time.
#[derive(Clone, Debug)]
pub struct SimulatedField {
    desk: Desk,
    simulated: Vec<Simulated>,
    now: u64,
}

impl SimulatedField {
    /// Set up the devices of a mapping whose sensors show these inputs.
    ///
    /// # Errors
    /// [`FieldError`] if a device cannot be simulated.
    pub fn new(mapping: Arc<Mapping>, inputs: &DeviceInputs) -> Result<Self, FieldError> {
        let simulated = mapping.devices.iter().map(simulated).collect::<Result<_, _>>()?;
        let mut field = Self { desk: Desk::new(mapping), simulated, now: 0 };
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

    /// The outputs of a tick as they arrive at the valves. `is_cut` is true for devices without a connection.
    pub fn write(
        &mut self,
        tick: Tick,
        outputs: &DeviceOutputs,
        is_cut: impl Fn(&str) -> bool,
    ) -> DeviceOutputs {
        let slot = SET_UP_MS + tick.0.saturating_mul(TICK_MS);
        self.desk.order(tick, outputs);
        for (simulated, planned) in self.simulated.iter_mut().zip(&self.desk.mapping().devices) {
            simulated.cut(is_cut(&planned.name));
        }
        self.exchange((slot + EXCHANGES_MS[0]) * MS);
        let mut arriving = *outputs;
        let mapping = self.desk.mapping();
        let images: Vec<OutWords> = self.simulated.iter().zip(&mapping.devices).map(at_the_valves).collect();
        mapping.spread(&images, &mut arriving);
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

    /// End: each device gets the outputs of the end and reads them back, or does not answer. `inputs` are the last
    /// ones of the controller.
    pub fn end(&mut self, inputs: &DeviceInputs) {
        self.desk.end();
        for time in (self.now / MS + 1..).step_by(ENDING_STEP_MS).take(ENDING_STEPS) {
            self.exchange(time * MS);
        }
        self.observe(self.now);
        self.desk.note_changes(inputs);
    }

    /// Copy the sensors into the registers of the couplers.
    fn sense(&mut self, inputs: &DeviceInputs) {
        let mapping = self.desk.mapping();
        let mut images = vec![InWords::ZERO; self.simulated.len()];
        mapping.sample(inputs, &mut images);
        for ((simulated, image), planned) in self.simulated.iter_mut().zip(images).zip(&mapping.devices) {
            let registers = simulated.coupler_mut().inputs_mut();
            if let Some(span) = planned.plan.reads.first() {
                let there = registers.iter_mut().skip(usize::from(span.first)).take(span.words());
                there.zip(image.words).for_each(|(register, word)| *register = word);
            }
        }
    }

    fn exchange(&mut self, now: u64) {
        for (simulated, orders) in self.simulated.iter_mut().zip(self.desk.orders()) {
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
    let registers = |spans: &[couplers::Span], first: usize| {
        let end = |span: &couplers::Span| (usize::from(span.first) + span.words()).checked_sub(first);
        match spans {
            [] => Some(0),
            [span] if !span.area.has_bits() => end(span).filter(|end| *end <= WORDS),
            _ => None,
        }
    };
    let sizes = registers(&plan.reads, 0).zip(registers(&plan.writes, OUTPUTS));
    let sizes = sizes.filter(|_| plan.kind == couplers::Kind::Bk9000);
    let sizes =
        sizes.and_then(|(inputs, outputs)| Some((u16::try_from(inputs).ok()?, u16::try_from(outputs).ok()?)));
    let name = || planned.name.clone();
    let (inputs, outputs) = sizes.ok_or_else(|| FieldError::NotEmulated { device: name() })?;
    let coupler = Emulated::new(plan.kind, plan.unit, inputs, outputs);
    Simulated::new(plan.clone(), coupler, TIMEOUT_MS)
        .map_err(|source| FieldError::Plan { device: name(), source })
}

/// The outputs of a coupler as an image.
fn at_the_valves((simulated, planned): (&Simulated, &field::Device)) -> OutWords {
    let mut image = OutWords::ZERO;
    if let Some(span) = planned.plan.writes.first() {
        let first = usize::from(span.first).saturating_sub(OUTPUTS);
        let registers = simulated.coupler().outputs().iter().skip(first).take(span.words());
        image.words.iter_mut().zip(registers).for_each(|(word, register)| *word = *register);
    }
    image
}

#[cfg(test)]
mod tests;
