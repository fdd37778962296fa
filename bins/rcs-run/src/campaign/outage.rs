//! An outage: the connections of couplers are cut for a time. Then a person releases the devices that have tripped
//! (`io go`), and the operator repeats the failed line (`job go`).
//!
//! `robot` names the line to the robot controller, in addition to the devices of the mapping.

use std::fmt;

use closed_loop::field::{FieldChange, FieldEvent};
use couplers::{OutWords, State};
use depc::fault::{FaultKind, Plan, Rule};
use field::Mapping;
use plant::CellEvent;
use rcs_core::tick::{TICK_MS, Tick};

use super::{branch::Branch, script::ScriptStep};

pub const WORD: &str = "outage";
const ROBOT: &str = "robot";
/// Durations of an outage without SECONDS, ms. A cut of 60 ms is shorter than `stale_ms`, one of 500 ms trips.
const TIMES_MS: [u64; 5] = [60, 200, 500, 2000, 10_000];
const MOST_S: f64 = 3600.0;
/// Ticks from the end of an outage to the first release: the time in which a person reads the alarm. CHOSEN: 1 s.
const REACTION: u64 = 25;
/// Ticks between two releases, and ticks after which the operator gives up: one minute.
const AGAIN: u64 = 5;
pub const RELEASE_LIMIT: u64 = 1500;

#[derive(Clone, Debug, PartialEq)]
pub struct Outage {
    pub devices: Vec<String>,
    pub ms: u64,
}

impl fmt::Display for Outage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { devices, ms } = self;
        write!(f, "{WORD}:{}:{}", devices.join("/"), *ms as f64 / 1000.0)
    }
}

impl Outage {
    /// The outages that `DEVICE[/DEVICE][:SECONDS]` selects; `None` for another text.
    #[must_use]
    pub fn named(text: &str) -> Option<Vec<Self>> {
        let (devices, seconds) = text.split_once(':').map_or((text, None), |(devices, s)| (devices, Some(s)));
        let devices: Vec<String> = devices.split('/').map(str::to_owned).collect();
        if devices.iter().any(String::is_empty) {
            return None;
        }
        let times = match seconds {
            None => TIMES_MS.to_vec(),
            Some(seconds) => {
                let seconds = seconds.parse::<f64>().ok().filter(|s| (0.001..=MOST_S).contains(s))?;
                vec![(seconds * 1000.0).round() as u64]
            }
        };
        Some(times.into_iter().map(|ms| Self { devices: devices.clone(), ms }).collect())
    }

    /// Why a run with this mapping cannot have the outage; `None` if it can.
    #[must_use]
    pub fn refusal(&self, mapping: Option<&Mapping>) -> Option<String> {
        let couplers = || self.devices.iter().filter(|device| *device != ROBOT);
        let Some(mapping) = mapping else {
            let first = couplers().next()?;
            return Some(format!("{self}: {first} needs emulated couplers: add --field sim:NAME"));
        };
        let unknown = couplers().find(|device| mapping.device(device).is_none())?;
        let names: Vec<&str> = mapping.devices.iter().map(|device| device.name.as_str()).collect();
        Some(format!(
            "{self}: expected {ROBOT} or a device of the mapping, one of {}; found {unknown}",
            names.join(", ")
        ))
    }

    #[must_use]
    pub fn steps(&self) -> Vec<ScriptStep> {
        // The cut begins within a tick.
        let ticks = self.ms.div_ceil(TICK_MS) + 1;
        let mut steps = vec![ScriptStep::Outage(self.clone()), ScriptStep::Wait(ticks), ScriptStep::Release];
        if self.devices.iter().any(|device| device == ROBOT) {
            steps.extend([ScriptStep::Enter, ScriptStep::StartUp]);
        }
        steps
    }

    /// Cuts the connections after the last tick of a branch.
    pub fn begin(&self, branch: &mut Branch<'_>) {
        let at = branch.at().0;
        // The place in the tick differs between branches, but not between runs.
        let after = at * 37 % TICK_MS;
        for device in &self.devices {
            if device == ROBOT {
                let mut plan = Plan::new(0);
                let ticks = self.ms.div_ceil(TICK_MS);
                // A plan with a single rule accepts every rule.
                let _ = plan.add(Rule::new(FaultKind::Drop).window(at + 1, at + 1 + ticks));
                branch.closed.line_mut().replace_plan(&plan);
            } else if let Some(field) = branch.field_mut() {
                field.cut(device, after, self.ms);
            }
        }
    }
}

/// Sends `io go` to the tripped devices `ticks` after the end of the outage. True if all devices are running.
pub fn release(branch: &mut Branch<'_>, ticks: u64) -> bool {
    let Some(field) = branch.field_mut() else { return true };
    let desk = field.desk_mut();
    let states: Vec<(String, State)> =
        desk.devices().map(|(device, _, report, _)| (device.name.clone(), report.state)).collect();
    if ticks >= REACTION && ticks.is_multiple_of(AGAIN) {
        for (device, _) in states.iter().filter(|(_, state)| matches!(state, State::Tripped(_))) {
            desk.release(device);
        }
    }
    states.iter().all(|(_, state)| *state == State::Running)
}

/// Watches the promises of field I/O: nothing falls or slips, and no output that may not be on at rest is switched on
/// from the time at which its device is late until it is back or released.
#[derive(Default)]
pub struct OutageMonitor {
    images: Vec<OutWords>,
    has_released: bool,
}

impl OutageMonitor {
    /// True if a person had to release a device.
    #[must_use]
    pub const fn has_released(&self) -> bool {
        self.has_released
    }

    /// The broken promises of the last tick.
    pub fn look(&mut self, branch: &Branch<'_>) -> Vec<String> {
        self.has_released |= branch.field_events.iter().any(|event| event.what == FieldChange::Released);
        let slips = branch.events.iter().filter(|event| matches!(event, CellEvent::Slipped { .. }));
        let mut broken: Vec<String> = slips.map(ToString::to_string).collect();
        let Some(field) = branch.field() else { return broken };
        let images = field.images();
        let desk = field.desk();
        let mapping = desk.mapping();
        let devices = desk.devices().zip(images.iter().zip(&self.images)).enumerate();
        for (index, ((device, _, report, _), (image, before))) in devices {
            if report.state == State::Running {
                continue;
            }
            let risen = mapping.outputs_on(index, image).filter(|point| point.get(before) == point.safe);
            broken.extend(risen.map(|point| {
                format!("{} is switched on while {} is {}", point.name, device.name, report.state.word())
            }));
        }
        self.images = images;
        broken
    }
}

/// The events of couplers of the last tick that a story tells.
pub fn told(branch: &Branch<'_>) -> impl Iterator<Item = (Tick, String)> {
    let at = branch.at();
    branch.field_events.iter().map(move |event: &FieldEvent| (at, event.to_string()))
}

#[cfg(test)]
mod tests;
