//! Lines of a job that the devices of the workstation execute: outputs are set, inputs show the progress.
//!
//! ```text
//!              needs hold              begun          done, which was off before
//!   begin ──► Checking ──► Setting ──► Running ─────────────────────────────────► ended
//!                 │ sets are written    │ then is written, so that no start output stays on
//!                 └──────────┴──────────┴──► failed: fault, `while` lost, too late, tripped device
//! ```
//!
//! [`table`] decides. A late input neither fulfils nor breaks a condition. `done` is valid only after `begun`, after `done` was off, or,
//! without `begun`, after [`SETTLE_TICKS`], so that an input left on by the last cycle does not end a line. A line
//! interrupted after it had begun continues without a second start. One call of [`Lines::step`] is one tick.

mod failure;
mod table;

use rcs_core::tick::TICK_MS;

use self::table::{Action, Cause, Devices, Done, Held, Phase, Situation, Start, Time, Watched};

pub use self::failure::{Failure, Observed, Why};
use crate::{image::Seen, mapping::Mapping};

/// Ticks for which `done` must hold if it was on before the outputs were set, and the line has no `begun`. CHOSEN: 1 s,
/// longer than any of its devices needs to leave its limit switch.
pub const SETTLE_TICKS: u64 = 1000 / TICK_MS;
const TICKS_PER_S: u64 = 1000 / TICK_MS;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sequence {
    pub line: String,          // the words of the line without `**`, separated by one space
    pub ask: String,           // request to the operator; empty if devices execute the line
    pub needs: Vec<Condition>, // conditions before the outputs are set
    pub sets: Vec<Setting>,
    pub begun: Vec<Condition>, // the device has taken the order
    pub done: Vec<Condition>,
    pub during: Vec<Condition>, // conditions that must hold from the setting of the outputs to the end
    pub fault: Vec<Condition>,  // inputs that end the line with a failure
    /// Outputs that are set when `begun` becomes true; without `begun`, or after a failure, when the line ends.
    pub then: Vec<Setting>,
    pub begun_within_s: u16,
    pub within_s: u16,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Condition {
    pub input: usize, // index in the inputs of the mapping
    pub value: i64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    pub output: usize, // index in the outputs of the mapping
    pub value: i64,
}

/// A line with single spaces, as entries and jobs are compared.
#[must_use]
pub fn normalized(line: &str) -> String {
    line.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Current {
    entry: usize, // index in the lines of the mapping
    phase: Phase,
    ticks: u64, // ticks since the beginning of the line, and of the phase
    in_phase: u64,
    was_off: bool, // `done` was seen off since the line began
    held: u64,     // ticks for which `done` has held
}

/// The values that the outputs of the workstation may have after these lines and during the present one.
#[must_use]
pub fn outputs_after<'a>(
    mapping: &Mapping,
    lines: impl IntoIterator<Item = &'a str>,
    present: Option<&str>,
) -> Vec<Vec<i64>> {
    let mut devices = Lines::new(mapping);
    let sequence = |line: &str| mapping.lines.iter().find(|sequence| sequence.line == line);
    for sequence in lines.into_iter().filter_map(sequence) {
        devices.write(&sequence.sets);
        devices.write(&sequence.then);
    }
    let mut possible = vec![devices.outputs.clone()];
    if let Some(sequence) = present.and_then(sequence) {
        for settings in [&sequence.sets, &sequence.then] {
            devices.write(settings);
            possible.push(devices.outputs.clone());
        }
    }
    possible
}

/// The line that the devices execute now, and the outputs of all lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lines {
    outputs: Vec<i64>, // one value for each output of the mapping; only those of the workstation are used
    current: Option<Current>,
    interrupted: Option<usize>, // a line that had begun when a device was tripped
    failure: Option<Failure>,
}

impl Lines {
    #[must_use]
    pub fn new(mapping: &Mapping) -> Self {
        let outputs = mapping.outputs.iter().map(|point| point.safe).collect();
        Self { outputs, current: None, interrupted: None, failure: None }
    }

    #[must_use]
    pub fn outputs(&self) -> &[i64] {
        &self.outputs
    }

    /// Takes over the value of an output that an earlier run has set.
    pub fn adopt(&mut self, output: usize, value: i64) {
        self.write(&[Setting { output, value }]);
    }

    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.current.is_some()
    }

    /// The failure of a line, for one tick.
    #[must_use]
    pub const fn failure(&self) -> Option<&Failure> {
        self.failure.as_ref()
    }

    #[must_use]
    pub fn asks<'m>(&self, mapping: &'m Mapping) -> Option<&'m str> {
        let entry = self.current.and_then(|current| mapping.lines.get(current.entry))?;
        Some(entry.ask.as_str()).filter(|ask| !ask.is_empty())
    }

    /// Begins a line. Its conditions are checked by [`step`](Self::step). Fails if the mapping has no entry for the
    /// line, or another one is executed.
    pub fn begin(&mut self, mapping: &Mapping, line: &str) -> Result<(), Failure> {
        let failed = |why| Failure { line: line.to_owned(), why };
        if let Some(other) = self.current.and_then(|current| mapping.lines.get(current.entry)) {
            return Err(failed(Why::Occupied(other.line.clone())));
        }
        let entry = mapping.lines.iter().position(|sequence| sequence.line == line);
        let entry = entry.ok_or_else(|| failed(Why::NoEntry))?;
        let continues = self.interrupted.take() == Some(entry);
        let phase = if continues { Phase::Running } else { Phase::Checking };
        self.current = Some(Current { entry, phase, ticks: 0, in_phase: 0, was_off: continues, held: 0 });
        Ok(())
    }

    pub fn step(&mut self, mapping: &Mapping, devices: &[Seen]) {
        self.failure = None;
        let Some(mut current) = self.current else { return };
        let Some(sequence) = mapping.lines.get(current.entry) else { return };
        let facts = Facts::of(mapping, sequence, devices);
        current.ticks += 1;
        current.in_phase += 1;
        current.was_off |= facts.done == Held::No;
        current.held = if facts.done == Held::Yes { current.held + 1 } else { 0 };
        let decision = table::line(current.phase, &facts.situation(&current, sequence));
        let (before, next) = (current.phase, decision.next);
        if next != before {
            (current.in_phase, current.held) = (0, 0);
        }
        current.phase = next;
        match decision.action {
            Action::Wait => {}
            Action::Set => self.write(&sequence.sets),
            Action::Begin => {
                self.write(&sequence.then);
                current.was_off = true;
            }
            Action::End => {
                self.write(&sequence.then);
                self.current = None;
                return;
            }
            Action::Fail(cause) => {
                self.current = None;
                self.interrupted = (cause == Cause::Interrupted).then_some(current.entry);
                self.failure = Some(Failure { line: sequence.line.clone(), why: facts.why(cause, sequence) });
                if before != Phase::Checking {
                    self.write(&sequence.then);
                    self.release(mapping, sequence);
                }
                return;
            }
        }
        self.current = Some(current);
    }

    fn write(&mut self, settings: &[Setting]) {
        for setting in settings {
            if let Some(output) = self.outputs.get_mut(setting.output) {
                *output = setting.value;
            }
        }
    }

    /// Sets the outputs of a failed line that may not be on at rest to their safe value.
    fn release(&mut self, mapping: &Mapping, sequence: &Sequence) {
        for setting in &sequence.sets {
            let point = mapping.outputs.get(setting.output).filter(|point| !point.rest);
            if let Some((point, output)) = point.zip(self.outputs.get_mut(setting.output)) {
                *output = point.safe;
            }
        }
    }
}

#[derive(Debug)]
struct Facts {
    tripped: Option<String>, // a tripped device of the line
    needs: Held,
    begun: Held,
    done: Held,
    missing_need: Option<Observed>, // the first conditions that do not hold, for messages
    missing_begun: Option<Observed>,
    missing_done: Option<Observed>,
    lost: Option<Observed>,
    fault: Option<Observed>,
}

impl Facts {
    fn of(mapping: &Mapping, sequence: &Sequence, devices: &[Seen]) -> Self {
        let observed = |condition: &Condition| Observed {
            point: mapping.inputs.get(condition.input).map_or_else(String::new, |point| point.name.clone()),
            found: mapping.station_value(condition.input, devices),
            expected: condition.value,
        };
        let holds = |condition: &Condition| {
            mapping.station_value(condition.input, devices).map(|found| found == condition.value)
        };
        let all = |conditions: &[Condition]| {
            let held: Vec<Option<bool>> = conditions.iter().map(holds).collect();
            match (held.contains(&Some(false)), held.contains(&None)) {
                (true, _) => Held::No,
                (false, true) => Held::Late,
                (false, false) => Held::Yes,
            }
        };
        let missing = |conditions: &[Condition]| {
            conditions.iter().find(|condition| holds(condition) != Some(true)).map(observed)
        };
        let first = |conditions: &[Condition], state: bool| {
            conditions.iter().find(|condition| holds(condition) == Some(state)).map(observed)
        };
        let inputs = [&sequence.needs, &sequence.begun, &sequence.done, &sequence.during, &sequence.fault];
        let read = inputs.into_iter().flatten().filter_map(|one| mapping.inputs.get(one.input)?.device());
        let written = sequence.sets.iter().filter_map(|one| Some(mapping.outputs.get(one.output)?.device()));
        let mut used = read.chain(written);
        let is_tripped = |device: &usize| devices.get(*device).is_some_and(|seen| seen.is_tripped);
        let tripped = used.find(is_tripped).and_then(|device| mapping.devices.get(device));
        Self {
            tripped: tripped.map(|device| device.name.clone()),
            needs: all(&sequence.needs),
            begun: all(&sequence.begun),
            done: all(&sequence.done),
            missing_need: missing(&sequence.needs),
            missing_begun: missing(&sequence.begun),
            missing_done: missing(&sequence.done),
            lost: first(&sequence.during, false),
            fault: first(&sequence.fault, true),
        }
    }

    fn situation(&self, current: &Current, sequence: &Sequence) -> Situation {
        let watched =
            |broken: &Option<Observed>| if broken.is_some() { Watched::Broken } else { Watched::Kept };
        let limit = |ticks: u64, seconds: u16| match ticks >= u64::from(seconds) * TICKS_PER_S {
            true => Time::Over,
            false => Time::Left,
        };
        let has_settled = sequence.begun.is_empty() && current.held >= SETTLE_TICKS;
        Situation {
            devices: if self.tripped.is_some() { Devices::Tripped } else { Devices::Released },
            start: if sequence.begun.is_empty() { Start::Hidden } else { Start::Shown },
            fault: watched(&self.fault),
            during: watched(&self.lost),
            needs: self.needs,
            begun: self.begun,
            done: match self.done {
                Held::Yes if current.was_off || has_settled => Done::Reached,
                Held::Yes => Done::Unproven,
                Held::No | Held::Late => Done::Missing,
            },
            start_time: limit(current.in_phase, sequence.begun_within_s),
            time: limit(current.ticks, sequence.within_s),
        }
    }

    /// Names the point or the device of a failure.
    fn why(self, cause: Cause, sequence: &Sequence) -> Why {
        let device = self.tripped.unwrap_or_default();
        let observed = |what: Option<Observed>| what.unwrap_or_default();
        match cause {
            Cause::Tripped => Why::Tripped(device),
            Cause::Unknown => Why::Unknown(device),
            Cause::Interrupted => Why::Interrupted(device),
            Cause::Fault => Why::Fault(observed(self.fault)),
            Cause::Lost => Why::Lost(observed(self.lost)),
            Cause::Needs => Why::Needs(observed(self.missing_need)),
            Cause::NotBegun => Why::NotBegun(observed(self.missing_begun), sequence.begun_within_s),
            Cause::NotDone => Why::NotDone(observed(self.missing_done), sequence.within_s),
        }
    }
}

#[cfg(test)]
mod tests;
