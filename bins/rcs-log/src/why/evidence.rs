//! The inputs of the devices during a command: the end of a causal chain.
//!
//! A switch has its value and the ticks of its changes, a converter its range. One line lists all inputs that never
//! changed; absent devices are left out. For a guarded move the lines state the condition that would have ended it, the
//! nearest reading, and the distance that the robot moved.

use geometry::pose::WireFrame;
use interfaces::{ExternalInputs, prim::PrimVerb};
use levels::{
    ladder::{LadderState, ProcessId},
    prim::{sensors::GuardReading, tables},
};
use rcs_core::{
    Plain,
    plain::{Schema, Writer, from_bytes},
    reflect,
};
use record::{
    Log,
    layout::{self, Leaf},
    replay::generations,
};
use taskdata::files::{SensorPara, SensorSource};

use crate::story::{Moment, moments};

const CHANGES: usize = 8; // greatest number of changes listed for a switch; more changes are only counted

#[derive(Default)]
pub struct Evidence {
    pub guard: Option<String>,
    pub devices: Vec<String>,
}

struct Trace {
    leaf: Leaf,
    changes: Vec<(u64, String)>, // ticks of the changes, each with the new value
    least: u64,
    most: u64,
}

pub fn gather(log: &Log, process: ProcessId, from: u64, until: u64) -> Evidence {
    let wanted = |leaf: &Leaf| process.reads().iter().any(|prefix| leaf.path.starts_with(prefix));
    let mut traces: Vec<Trace> = layout::leaves(ExternalInputs::STRUCT)
        .into_iter()
        .filter(wanted)
        .map(|leaf| Trace { leaf, changes: Vec::new(), least: u64::MAX, most: 0 })
        .collect();
    let mut image = vec![0; ExternalInputs::SIZE];
    let (mut guard, mut frames) = (Guard::new(log, process), Vec::new());
    for (moment, state) in moments(log) {
        if let Some(state) = state {
            guard.learn(&state);
        }
        if moment.tick.0 < from {
            continue;
        }
        if moment.tick.0 > until {
            break;
        }
        moment.external.encode(&mut Writer::new(&mut image));
        traces.iter_mut().for_each(|trace| trace.look(moment.tick.0, &image));
        guard.look(&moment);
        frames.extend(moment.after.t3i.status.resolver_frame);
    }
    Evidence { guard: guard.tell(travel(&frames)), devices: tell(&traces) }
}

/// One line per changed input, and one line for all others.
fn tell(traces: &[Trace]) -> Vec<String> {
    let mut lines: Vec<String> = traces.iter().filter_map(Trace::tell).collect();
    let steady: Vec<String> = traces.iter().filter_map(Trace::steady).collect();
    if !steady.is_empty() {
        lines.push(format!("unchanged: {}", steady.join(", ")));
    }
    lines
}

/// Distance between the first and the last frame, inches.
fn travel(frames: &[WireFrame]) -> f64 {
    let known = |frame: &WireFrame| frame.to_frame().ok();
    match (frames.first().and_then(known), frames.last().and_then(known)) {
        (Some(first), Some(last)) => first.distance(&last).inches,
        _ => 0.0,
    }
}

impl Trace {
    const fn is_converter(&self) -> bool {
        matches!(self.leaf.schema, Schema::U16 | Schema::I16 | Schema::U32 | Schema::I32)
    }

    fn look(&mut self, tick: u64, image: &[u8]) {
        let bytes = self.leaf.bytes(image);
        if self.is_converter() {
            let value = reflect::unsigned(bytes);
            (self.least, self.most) = (self.least.min(value), self.most.max(value));
            return;
        }
        let value = self.leaf.text(image);
        if self.changes.last().is_none_or(|(_, last)| *last != value) {
            self.changes.push((tick, value));
        }
    }

    fn name(&self) -> &str {
        self.leaf.path.trim_start_matches("devices.")
    }

    /// Name and value of an input that never changed; `None` if it was off or zero.
    fn steady(&self) -> Option<String> {
        let value = match (self.is_converter(), self.changes.as_slice()) {
            (true, _) if self.least == self.most => self.least.to_string(),
            (false, [(_, value)]) => value.clone(),
            _ => return None,
        };
        let nothing = value.trim_matches('"').chars().all(|c| c == '0') || value == "false";
        (!nothing).then(|| format!("{} {value}", self.name()))
    }

    /// A line about an input that changed; `None` if it did not.
    fn tell(&self) -> Option<String> {
        let name = self.name();
        if self.is_converter() {
            return (self.least < self.most)
                .then(|| format!("{name} was between {} and {}", self.least, self.most));
        }
        let (_, first) = self.changes.first()?;
        match self.changes.get(1..)? {
            [] => None,
            more if more.len() > CHANGES => Some(format!("{name} changed {} times", more.len())),
            more => {
                let told: Vec<String> =
                    more.iter().map(|(tick, value)| format!("{value} at tick {tick}")).collect();
                Some(format!("{name} was {first}, then {}", told.join(", then ")))
            }
        }
    }
}

struct Guard {
    sensors: Vec<SensorPara>,
    state: Option<Box<LadderState>>,
    sensor: Option<SensorPara>,
    number: u32,          // number of the command that names the sensor
    nearest: Option<f64>, // the reading nearest to the threshold
    met: bool,
    is_prim: bool,
}

impl Guard {
    fn new(log: &Log, process: ProcessId) -> Self {
        // Without task data the thresholds are unknown; the failure is then explained without them.
        let sensors = generations(log).ok().and_then(|mut all| all.pop());
        let sensors = sensors.map_or_else(Vec::new, |store| store.view().sensors.to_vec());
        Self {
            sensors,
            state: None,
            sensor: None,
            number: 0,
            nearest: None,
            met: false,
            is_prim: process == ProcessId::Prim,
        }
    }

    fn learn(&mut self, state: &[u8]) {
        self.state = from_bytes(state).ok().map(Box::new);
    }

    fn look(&mut self, moment: &Moment) {
        let command = &moment.before.emove.prim;
        if !self.is_prim || !matches!(command.command, PrimVerb::GoUntil | PrimVerb::GoWhile) {
            return;
        }
        let Some(sensor) = self.sensors.iter().find(|sensor| Some(sensor.name) == command.sensor) else {
            return;
        };
        if self.number != command.number {
            (self.number, self.nearest, self.met) = (command.number, None, false);
        }
        self.sensor = Some(*sensor);
        let Some(state) = &self.state else { return };
        let devices = &moment.external.devices;
        let GuardReading { guard, value } =
            state.prim.calibration.read(sensor, devices, command.end_effector_id);
        self.met |= guard == tables::Guard::Met;
        let nearer = |last: f64| if sensor.threshold < 0 { last.min(value) } else { last.max(value) };
        self.nearest = Some(self.nearest.map_or(value, nearer));
    }

    fn tell(&self, travelled: f64) -> Option<String> {
        let sensor = self.sensor.as_ref()?;
        let name = sensor_name(sensor);
        let way = format!("in the {travelled:.2} in that the tool went");
        Some(match (sensor.source.is_force(), self.nearest) {
            (_, None) => format!("the sensor {name} was not read {way}"),
            (true, Some(nearest)) => force_words(sensor, nearest, &way),
            (false, Some(_)) if self.met => format!("{name} came true {way}"),
            (false, Some(_)) => format!("{name} never came true {way}"),
        })
    }
}

/// The distance of a force from its threshold, or its excess over it, as text.
fn force_words(sensor: &SensorPara, nearest: f64, way: &str) -> String {
    let (name, threshold) = (sensor_name(sensor), sensor.threshold);
    let unit = if sensor.source == SensorSource::My { "in lb" } else { "lb" };
    let (reached, word) = match threshold < 0 {
        true => (nearest <= f64::from(threshold), "least"),
        false => (nearest >= f64::from(threshold), "most"),
    };
    match reached {
        true => format!("{name} reached {nearest:.1} {unit} {way}, and its threshold is {threshold} {unit}"),
        false => format!(
            "{name} never reached its threshold of {threshold} {unit} {way}: it was {nearest:.1} {unit} at {word}"
        ),
    }
}

fn sensor_name(sensor: &SensorPara) -> String {
    let what = match (sensor.source, sensor.which) {
        (SensorSource::Near | SensorSource::Seated, holster) => {
            format!("{} in holster {holster}", sensor.source)
        }
        (SensorSource::Beam, 0) => "any beam between the fingers".to_owned(),
        (SensorSource::Beam, beam) => format!("beam {beam} between the fingers"),
        (SensorSource::My, _) => "moment about the tool's Y".to_owned(),
        (force, _) => format!("force {force} on the tool"),
    };
    format!("\"{}\" ({what})", sensor.name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_processes_read_are_inputs() {
        let leaves = layout::leaves(ExternalInputs::STRUCT);
        for read in ProcessId::ALL.iter().flat_map(|process| process.reads()) {
            assert!(leaves.iter().any(|leaf| leaf.path.starts_with(read)), "{read}");
        }
    }
}
