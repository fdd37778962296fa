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

use std::{fmt, sync::Arc};

use couplers::{
    Emulated, InWords, MS, Mode, Orders, OutWords, PlanError, Simulated, State, Trip, report::Counters,
};
use field::{Mapping, Seen};
use interfaces::{DeviceInputs, DeviceOutputs};
use rcs_core::{
    Plain as _,
    tick::{TICK_MS, Tick},
};

/// Simulated time before the first tick, for the set-up of the devices, ms.
const SET_UP_MS: u64 = 2000;
/// Times of the two exchanges after a slot, ms.
const EXCHANGES_MS: [u64; 2] = [1, TICK_MS - 8];
/// Answer timeout, ms; also the duration of an exchange over a cut connection.
const TIMEOUT_MS: u16 = 6;
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

#[derive(Clone, Debug, PartialEq)]
pub struct FieldEvent {
    pub device: String,
    pub what: Happened,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Happened {
    /// The device has not answered for this time, ms.
    Stale(u32),
    /// The device answers again after this time, ms, and continues.
    Back(u32),
    /// The outputs of the device are safe until an operator releases it.
    Tripped(Trip),
    Released,
    /// The release was refused: an output that must be off at rest is commanded, or the device does not answer.
    Refused,
}

impl FieldEvent {
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self.what {
            Happened::Stale(_) => "io.stale",
            Happened::Back(_) => "io.back",
            Happened::Tripped(_) => "io.tripped",
            Happened::Released => "io.released",
            Happened::Refused => "io.refused",
        }
    }
}

impl fmt::Display for FieldEvent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { device, what } = self;
        match what {
            Happened::Stale(ms) => {
                write!(f, "{device} has not answered for {ms} ms; its inputs keep their values")
            }
            Happened::Back(ms) => write!(f, "{device} answers again after {ms} ms"),
            Happened::Tripped(Trip::Gap(ms)) => write!(
                f,
                "{device} was not written for {ms} ms: its outputs are safe until an operator sends `io go {device}`"
            ),
            Happened::Tripped(trip) => write!(
                f,
                "{device} is tripped, since {}: its outputs are safe until an operator sends `io go {device}`",
                cause(*trip)
            ),
            Happened::Released => write!(f, "{device} is released"),
            Happened::Refused => write!(
                f,
                "{device} is not released: it does not answer, or an output is on that may not be on at rest"
            ),
        }
    }
}

/// The reason of a trip, as the end of a sentence.
const fn cause(trip: Trip) -> &'static str {
    match trip {
        Trip::Gap(_) => "it was not written in time",
        Trip::Outputs => "its outputs are not those that were written",
        Trip::Settings => "its settings are not those that were made",
        Trip::Refused(_) => "it refused a write",
        Trip::Terminals(_) => "its terminals report an error",
        Trip::Frozen => "the counter of its program stands still",
        Trip::NoOrders => "the controller gave no orders",
        Trip::Ordered => "an operator, or the safety circuit, asked for it",
    }
}

#[derive(Clone, Debug)]
struct Device {
    simulated: Simulated,
    orders: Orders,
    /// State of its session after the last tick.
    state: State,
    refused: u32,
    /// Time since which its inputs are old, ns.
    read_at: u64,
}

/// The couplers of a mapping, in simulated time.
#[derive(Clone, Debug)]
pub struct SimulatedField {
    mapping: Arc<Mapping>,
    devices: Vec<Device>,
    now: u64,
    events: Vec<FieldEvent>,
}

impl SimulatedField {
    /// Set up the devices of a mapping whose sensors show these inputs.
    ///
    /// # Errors
    /// [`FieldError`] if a device cannot be simulated.
    pub fn new(mapping: Arc<Mapping>, inputs: &DeviceInputs) -> Result<Self, FieldError> {
        let devices = mapping.devices.iter().map(device).collect::<Result<_, _>>()?;
        let mut field = Self { mapping, devices, now: 0, events: Vec::new() };
        field.sense(inputs);
        for tick in 0..SET_UP_MS / TICK_MS {
            for offset in EXCHANGES_MS {
                field.exchange((tick * TICK_MS + offset) * MS);
            }
        }
        field.now = SET_UP_MS * MS;
        for (device, planned) in field.devices.iter_mut().zip(&field.mapping.devices) {
            let state = device.simulated.report().state;
            if state != State::Running {
                return Err(FieldError::NotReady { device: planned.name.clone() });
            }
            device.state = state;
            device.orders.mode = Mode::Run;
        }
        Ok(field)
    }

    #[must_use]
    pub fn mapping(&self) -> &Mapping {
        &self.mapping
    }

    /// The outputs of a tick as they arrive at the valves. `is_cut` is true for devices without a connection.
    pub fn write(
        &mut self,
        tick: Tick,
        outputs: &DeviceOutputs,
        is_cut: impl Fn(&str) -> bool,
    ) -> DeviceOutputs {
        let slot = SET_UP_MS + tick.0.saturating_mul(TICK_MS);
        let mut images = vec![OutWords::ZERO; self.devices.len()];
        self.mapping.collect(outputs, &mut images);
        for ((device, image), planned) in self.devices.iter_mut().zip(images).zip(&self.mapping.devices) {
            (device.orders.tick, device.orders.words) = (tick.0, image);
            device.simulated.cut(is_cut(&planned.name));
        }
        self.exchange((slot + EXCHANGES_MS[0]) * MS);
        let mut arriving = *outputs;
        let images: Vec<OutWords> =
            self.devices.iter().zip(&self.mapping.devices).map(at_the_valves).collect();
        self.mapping.spread(&images, &mut arriving);
        arriving
    }

    /// The inputs of the next tick, from the sensors after `tick`.
    pub fn read(&mut self, tick: Tick, inputs: &DeviceInputs) -> DeviceInputs {
        let slot = SET_UP_MS + tick.0.saturating_mul(TICK_MS);
        self.sense(inputs);
        self.exchange((slot + EXCHANGES_MS[1]) * MS);
        self.now = (slot + TICK_MS) * MS;
        self.note_changes();
        self.inputs(inputs)
    }

    /// The inputs of the next tick: the words of the devices, and unmapped words directly from the sensors.
    #[must_use]
    pub fn inputs(&self, inputs: &DeviceInputs) -> DeviceInputs {
        let seen: Vec<Seen<'_>> = self.devices.iter().map(|device| device.seen(self.now)).collect();
        let mut arrived = *inputs;
        self.mapping.apply(&seen, &mut arrived);
        arrived
    }

    /// Release a tripped device. Returns false for an unknown name.
    pub fn release(&mut self, name: &str) -> bool {
        let index = self.mapping.device(name);
        let device = index.and_then(|index| self.devices.get_mut(index));
        device.map(|device| device.orders.go = device.orders.go.wrapping_add(1)).is_some()
    }

    /// The events since the last call.
    pub fn take_events(&mut self) -> Vec<FieldEvent> {
        std::mem::take(&mut self.events)
    }

    pub fn counters(&self) -> impl Iterator<Item = (&str, Counters)> {
        let counted = self.devices.iter().map(|device| device.simulated.report().counters);
        self.mapping.devices.iter().map(|planned| planned.name.as_str()).zip(counted)
    }

    /// State and input age of each device for the status: `arm 8 ms, fixture STALE 0.4 s`.
    #[must_use]
    pub fn status(&self) -> String {
        let states = self.devices.iter().zip(&self.mapping.devices).map(|(device, planned)| {
            let age_ms = device.simulated.report().age(self.now).unwrap_or_default() / MS;
            let seconds = age_ms as f64 / 1000.0;
            match device.simulated.report().state {
                State::Running => format!("{} {age_ms} ms", planned.name),
                State::Stale => format!("{} STALE {seconds:.1} s", planned.name),
                State::Tripped(_) => format!("{} TRIPPED", planned.name),
                State::Starting => format!("{} STARTING", planned.name),
                State::Silent => format!("{} SILENT", planned.name),
                State::Ended(_) => format!("{} ended", planned.name),
            }
        });
        states.collect::<Vec<_>>().join(", ")
    }

    /// Copy the sensors into the registers of the couplers.
    fn sense(&mut self, inputs: &DeviceInputs) {
        let mut images = vec![InWords::ZERO; self.devices.len()];
        self.mapping.sample(inputs, &mut images);
        for ((device, image), planned) in self.devices.iter_mut().zip(images).zip(&self.mapping.devices) {
            let registers = device.simulated.coupler_mut().inputs_mut();
            if let Some(span) = planned.plan.reads.first() {
                let there = registers.iter_mut().skip(usize::from(span.first)).take(span.words());
                there.zip(image.words).for_each(|(register, word)| *register = word);
            }
        }
    }

    fn exchange(&mut self, now: u64) {
        for device in &mut self.devices {
            device.simulated.exchange(now, &device.orders);
        }
    }

    fn note_changes(&mut self) {
        let Self { devices, mapping, events, now, .. } = self;
        for (device, planned) in devices.iter_mut().zip(&mapping.devices) {
            let report = device.simulated.report();
            let gap = |since: u64| u32::try_from(now.saturating_sub(since) / MS).unwrap_or(u32::MAX);
            let what = match (device.state, report.state) {
                (_, State::Tripped(trip)) if !matches!(device.state, State::Tripped(_)) => {
                    Some(Happened::Tripped(trip))
                }
                (State::Tripped(_), State::Running) => Some(Happened::Released),
                (State::Running, State::Stale) => {
                    Some(Happened::Stale(gap(report.read_at.unwrap_or_default())))
                }
                (State::Stale, State::Running) => Some(Happened::Back(gap(device.read_at))),
                _ if report.counters.refused_releases != device.refused => Some(Happened::Refused),
                _ => None,
            };
            if report.state != State::Running || device.state == State::Running {
                device.read_at = report.read_at.unwrap_or_default();
            }
            (device.state, device.refused) = (report.state, report.counters.refused_releases);
            events.extend(what.map(|what| FieldEvent { device: planned.name.clone(), what }));
        }
    }
}

impl Device {
    fn seen(&self, now: u64) -> Seen<'_> {
        let report = self.simulated.report();
        let age_ms = report.age(now).map(|age| u32::try_from(age / MS).unwrap_or(u32::MAX));
        Seen { words: &report.inputs, age_ms, is_tripped: matches!(report.state, State::Tripped(_)) }
    }
}

fn device(planned: &field::Device) -> Result<Device, FieldError> {
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
    let simulated = Simulated::new(plan.clone(), coupler, TIMEOUT_MS)
        .map_err(|source| FieldError::Plan { device: name(), source })?;
    let orders = Orders { tick: 0, mode: Mode::Watch, go: 0, words: OutWords::ZERO };
    Ok(Device { simulated, orders, state: State::Starting, refused: 0, read_at: 0 })
}

/// The outputs of a coupler as an image.
fn at_the_valves((device, planned): (&Device, &field::Device)) -> OutWords {
    let mut image = OutWords::ZERO;
    if let Some(span) = planned.plan.writes.first() {
        let first = usize::from(span.first).saturating_sub(OUTPUTS);
        let registers = device.simulated.coupler().outputs().iter().skip(first).take(span.words());
        image.words.iter_mut().zip(registers).for_each(|(word, register)| *word = *register);
    }
    image
}

#[cfg(test)]
mod tests;
