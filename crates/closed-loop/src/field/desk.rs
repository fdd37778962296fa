//! State of the couplers of a run: orders of a tick, newest reports, events. The transport is elsewhere.

use std::{hint::black_box, sync::Arc};

use couplers::{MS, Mode, Orders, OutWords, Report, State};
use field::{Device, Mapping, Seen, Target};
use interfaces::{CommonMemory, DeviceInputs, DeviceOutputs, point::Kind};
use rcs_core::{Plain as _, tick::Tick};

use super::{
    FieldChange, FieldEvent,
    hold::{FoundOutputs, Hold},
};
use crate::devices::StationLines;

#[derive(Clone, Debug)]
struct Coupler {
    orders: Orders,
    report: Report,
    state: State, // state of its session after the last tick
    refused: u32,
    read_at: u64, // time since which its inputs are old, ns
}

#[derive(Clone, Debug)]
pub struct FieldController {
    mapping: Arc<Mapping>,
    couplers: Vec<Coupler>,
    images: Vec<OutWords>, // images and inputs of the devices, kept so that a tick does not allocate
    seen: Vec<Seen>,
    now: u64,
    events: Vec<FieldEvent>,
    lines: StationLines, // lines of the job that devices of the workstation execute
    hold: Option<Hold>,  // outputs of a resumed run before its first command
}

const OPERATOR: &str = "operator"; // name of the person who is asked, in events
const WORKSTATION: &str = "workstation"; // name of the simulated devices, in events

impl FieldController {
    /// Couplers that are being set up: nothing is written yet.
    #[must_use]
    pub fn new(mapping: Arc<Mapping>) -> Self {
        let orders = Orders { tick: 0, mode: Mode::Watch, go: 0, words: OutWords::ZERO };
        let report = Report::STARTING;
        let coupler = Coupler { orders, report, state: State::Starting, refused: 0, read_at: 0 };
        let seen = Seen { words: report.inputs, age_ms: None, is_tripped: false };
        let count = mapping.devices.len();
        Self {
            lines: StationLines::new(Arc::clone(&mapping)),
            mapping,
            couplers: vec![coupler; count],
            images: vec![OutWords::ZERO; count],
            seen: vec![seen; count],
            now: 0,
            events: Vec::new(),
            hold: None,
        }
    }

    #[must_use]
    pub fn mapping(&self) -> &Mapping {
        &self.mapping
    }

    /// Begin to write outputs. All devices must be set up.
    pub fn begin(&mut self) {
        for coupler in &mut self.couplers {
            (coupler.state, coupler.orders.mode) = (coupler.report.state, Mode::Run);
        }
    }

    /// The orders of a tick, with its outputs. Does not allocate.
    pub fn order(&mut self, tick: Tick, outputs: &DeviceOutputs) {
        self.mapping.collect(outputs, &mut self.images);
        self.mapping.collect_station(self.lines.outputs(), &mut self.images);
        if let Some(hold) = &self.hold {
            self.images.copy_from_slice(hold.images());
        }
        for (coupler, image) in self.couplers.iter_mut().zip(&self.images) {
            (coupler.orders.tick, coupler.orders.words) = (tick.0, *image);
        }
    }

    /// Compares the outputs of the devices with those of an earlier run: of its processes, in `memory`, and of its
    /// lines of the workstation, which may have one of the values of `station`. The devices keep what they have until a
    /// process gets a command.
    pub fn adopt(&mut self, memory: &CommonMemory, station: &[Vec<i64>]) -> FoundOutputs {
        let outputs = memory.device_outputs();
        let mut found_outputs = FoundOutputs::default();
        let mapping = Arc::clone(&self.mapping);
        for (index, point) in mapping.outputs.iter().enumerate().filter(|(_, point)| !point.is_lamp()) {
            let Some(coupler) = self.couplers.get(point.device()) else { continue };
            let found = point.get(&coupler.report.acknowledged);
            let possible = |values: &Vec<i64>| values.get(index).copied();
            let expected: Vec<i64> = match point.target {
                Target::Word(output) => vec![output.read(&outputs)],
                Target::Station => station.iter().filter_map(possible).collect(),
            };
            let (name, is_on) = (point.name.clone(), found != point.safe);
            if is_on && !(point.rest && expected.contains(&found)) {
                found_outputs.unknown.push((point.device(), name));
            } else if is_on {
                self.lines.adopt(index, found);
                found_outputs.adopted.push(name);
            } else if expected.iter().all(|value| *value != point.safe) && !expected.is_empty() {
                found_outputs.cleared.push(name);
            }
        }
        let images = self.couplers.iter().map(|coupler| coupler.report.acknowledged).collect();
        self.hold = Some(Hold::new(images, memory));
        found_outputs
    }

    /// Notes the commands of the processes after a tick: the first one ends the hold of a resumed run.
    pub fn note_commands(&mut self, memory: &CommonMemory) {
        self.hold.take_if(|hold| hold.ends(memory));
    }

    pub fn orders(&self) -> impl Iterator<Item = &Orders> {
        self.couplers.iter().map(|coupler| &coupler.orders)
    }

    /// Ends the couplers: each session writes the final outputs, reads them back and disconnects.
    pub fn end(&mut self) {
        for Coupler { orders, .. } in &mut self.couplers {
            (orders.tick, orders.mode) = (orders.tick.wrapping_add(1), Mode::End);
        }
    }

    /// The reports of all devices at the time `now`, ns. Does not allocate.
    pub fn observe(&mut self, now: u64, reports: impl Iterator<Item = Report>) {
        self.now = now;
        for ((coupler, seen), report) in self.couplers.iter_mut().zip(&mut self.seen).zip(reports) {
            coupler.report = report;
            let age_ms = report.age(now).map(|age| u32::try_from(age / MS).unwrap_or(u32::MAX));
            let is_tripped = matches!(report.state, State::Tripped(_));
            *seen = Seen { words: report.inputs, age_ms, is_tripped };
        }
    }

    pub fn reports(&self) -> impl Iterator<Item = &Report> {
        self.couplers.iter().map(|coupler| &coupler.report)
    }

    /// Replace the words of mapped points by those of the devices. Does not allocate.
    pub fn apply(&self, inputs: &mut DeviceInputs) {
        self.mapping.apply(&self.seen, inputs);
    }

    /// Use everything that a tick needs, so that it is in the caches. This does not affect the run.
    pub fn warm_up(&mut self) {
        let mut inputs = DeviceInputs::default();
        self.mapping.apply(&self.seen, &mut inputs);
        black_box(&inputs);
        self.mapping.collect(&DeviceOutputs::default(), &mut self.images);
    }

    /// Release a tripped device; refused while the safety circuit is open. Returns false for an unknown name.
    pub fn release(&mut self, name: &str) -> bool {
        if self.is_safety_open() {
            let is_known = self.mapping.device(name).is_some();
            let event = FieldEvent { device: name.to_owned(), what: FieldChange::Refused, held: Vec::new() };
            self.events.extend(is_known.then_some(event));
            return is_known;
        }
        self.with_orders(name, |orders| {
            orders.mode = Mode::Run;
            orders.go = orders.go.wrapping_add(1);
        })
    }

    /// Make the outputs of a device safe until it is released. Returns false for an unknown name.
    pub fn make_safe(&mut self, name: &str) -> bool {
        self.with_orders(name, |orders| orders.mode = Mode::Safe)
    }

    fn with_orders(&mut self, name: &str, change: impl FnOnce(&mut Orders)) -> bool {
        let index = self.mapping.device(name);
        let coupler = index.and_then(|index| self.couplers.get_mut(index));
        coupler.map(|coupler| change(&mut coupler.orders)).is_some()
    }

    #[must_use]
    pub const fn lines(&self) -> &StationLines {
        &self.lines
    }

    pub const fn lines_mut(&mut self) -> &mut StationLines {
        &mut self.lines
    }

    #[must_use]
    pub fn is_safety_open(&self) -> bool {
        self.mapping.is_safety_open(&self.seen)
    }

    /// An open safety circuit makes the outputs of all devices safe, until they are released.
    fn advance_lines(&mut self) {
        self.lines.step(&self.seen);
        if self.is_safety_open() {
            let running = self.couplers.iter_mut().filter(|coupler| coupler.orders.mode == Mode::Run);
            running.for_each(|coupler| coupler.orders.mode = Mode::Safe);
        }
        let asks = self.lines.news().map(FieldChange::Asks);
        let held = Vec::new();
        self.events.extend(asks.map(|what| FieldEvent { device: OPERATOR.to_owned(), what, held }));
    }

    /// Notes a message of a simulated device of the workstation.
    pub(super) fn note_message(&mut self, text: String) {
        let what = FieldChange::Message(text);
        self.events.push(FieldEvent { device: WORKSTATION.to_owned(), what, held: Vec::new() });
    }

    pub fn take_events(&mut self) -> Vec<FieldEvent> {
        std::mem::take(&mut self.events)
    }

    fn named(&self) -> impl Iterator<Item = (&str, &Coupler)> {
        self.mapping.devices.iter().map(|device| device.name.as_str()).zip(&self.couplers)
    }

    /// State and input age of each device for the status: `arm 8 ms, fixture STALE 0.4 s`.
    #[must_use]
    pub fn status(&self) -> String {
        let states = self.named().map(|(name, Coupler { report, .. })| {
            let age_ms = report.age(self.now).unwrap_or_default() / MS;
            let seconds = age_ms as f64 / 1000.0;
            match report.state {
                State::Running => format!("{name} {age_ms} ms"),
                State::Stale => format!("{name} STALE {seconds:.1} s"),
                state => format!("{name} {}", state.word().to_uppercase()),
            }
        });
        states.collect::<Vec<_>>().join(", ")
    }

    /// A point as text: raw word, value and age of an input, or an output as commanded and as acknowledged. `inputs`
    /// are those of the controller. `None` if the mapping has no such point.
    #[must_use]
    pub fn show(&self, name: &str, inputs: &DeviceInputs) -> Option<String> {
        let place = |device: usize| self.named().nth(device);
        if let Some(point) = self.mapping.inputs.iter().find(|point| point.name == name) {
            let value = match point.target {
                Target::Word(input) => format!(", {} in the controller", input.read(inputs)),
                Target::Station => String::new(),
            };
            let Some((device, coupler)) = point.device().and_then(place) else {
                return Some(format!("{name}: fixed{value}"));
            };
            let raw = point.raw(&coupler.report.inputs).unwrap_or_default();
            let age_ms = coupler.report.age(self.now).unwrap_or_default() / MS;
            return Some(format!("{name}: raw {raw}{value}; {device}, {age_ms} ms old"));
        }
        let point = self.mapping.outputs.iter().find(|point| point.name == name)?;
        let (device, coupler) = place(point.device())?;
        let [commanded, acknowledged] =
            [&coupler.orders.words, &coupler.report.acknowledged].map(|image| point.get(image));
        let state = coupler.report.state.word();
        Some(format!("{name}: commanded {commanded}, acknowledged {acknowledged}; {device} is {state}"))
    }

    /// The devices with their orders, newest reports and ages of inputs, ms.
    pub fn devices(&self) -> impl Iterator<Item = (&Device, &Orders, &Report, u64)> {
        let age = |report: &Report| report.age(self.now).unwrap_or_default() / MS;
        let couplers = self.couplers.iter().map(move |one| (&one.orders, &one.report, age(&one.report)));
        let devices = self.mapping.devices.iter().zip(couplers);
        devices.map(|(device, (orders, report, age))| (device, orders, report, age))
    }

    /// Notes the events of the newest reports, and carries out a tick of the present line.
    pub fn note_changes(&mut self, inputs: &DeviceInputs) {
        self.advance_lines();
        let Self { couplers, mapping, events, now, .. } = self;
        for (index, (coupler, device)) in couplers.iter_mut().zip(&mapping.devices).enumerate() {
            let report = &coupler.report;
            let gap = |since: u64| u32::try_from(now.saturating_sub(since) / MS).unwrap_or(u32::MAX);
            let what = match (coupler.state, report.state) {
                (before, State::Ended(is_confirmed)) if before != report.state => {
                    let on = mapping.outputs_not_safe(index, &report.acknowledged);
                    Some(FieldChange::Ended {
                        is_confirmed,
                        on: on.map(|point| point.name.clone()).collect(),
                    })
                }
                (_, State::Tripped(trip)) if !matches!(coupler.state, State::Tripped(_)) => {
                    Some(FieldChange::Tripped(trip))
                }
                (State::Tripped(_), State::Running) => Some(FieldChange::Released),
                (State::Running, State::Stale) => {
                    Some(FieldChange::Stale(gap(report.read_at.unwrap_or_default())))
                }
                (State::Stale, State::Running) => Some(FieldChange::Back(gap(coupler.read_at))),
                _ if report.counters.refused_releases != coupler.refused => Some(FieldChange::Refused),
                _ => None,
            };
            if report.state != State::Running || coupler.state == State::Running {
                coupler.read_at = report.read_at.unwrap_or_default();
            }
            (coupler.state, coupler.refused) = (report.state, report.counters.refused_releases);
            events.extend(what.map(|what| {
                let is_stale = matches!(what, FieldChange::Stale(_));
                let held = if is_stale { readings(mapping, index, inputs) } else { Vec::new() };
                FieldEvent { device: device.name.clone(), what, held }
            }));
        }
    }
}

/// The readings of the converters of a device that are not forces, by their points.
fn readings(mapping: &Mapping, device: usize, inputs: &DeviceInputs) -> Vec<(String, i64)> {
    let points = mapping.inputs.iter().filter(|point| point.device() == Some(device));
    let converters = points.filter_map(|point| match point.target {
        Target::Word(input) if input.kind() == Kind::Converter => {
            Some((point.name.clone(), input.read(inputs)))
        }
        _ => None,
    });
    converters.collect()
}
