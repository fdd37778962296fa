//! The undisturbed run: the line of the job in each tick, the world at the end of each line, and the changes.

use std::collections::HashSet;

use closed_loop::field::SimulatedField;
use couplers::OutWords;
use interfaces::{CommonMemory, Decided, DeviceOutputs, device::LinkBytes};
use levels::ladder::ProcessId;
use neighbours::workstation::player::{Hwsc, JobFailure, Progress, TIME_LIMIT};
use rcs_core::{name::Name16, tick::Tick};

use super::{
    branch::{Branch, Facility},
    harm::World,
};
use crate::rcs_run::error::Error;

/// Selects the ticks at which the parent is forked.
#[derive(Clone, Debug)]
pub enum Ticks {
    Every(u64),
    At(Vec<u64>),
    /// Ticks in which a step or a command number changes, and the two ticks after each.
    Changes,
    /// The first tick of each state of the control processes: their steps, and the rows that they fired last.
    States,
    /// Every n-th of the ticks within [`NEAR`] of a change of an output.
    Outputs(u64),
    /// Every n-th tick, and the ticks of `Changes`.
    Both(u64),
}

const NEAR: u64 = 10; // ticks before and after a change of an output

pub struct Parent {
    begun: Vec<Tick>, // first tick of each line; line 0 is the first PAUSE
    worlds: Vec<World>,
    changes: Vec<u64>,
    outputs: Vec<u64>, // ticks in which an output of a device changes
    states: Vec<u64>,
    pub ticks: u64,
    pub digest: String,
}

/// Steps and command numbers of all processes, without T3 Interface, which gets one command per point.
type Steps = Vec<(Option<Name16>, Option<u32>)>;

fn steps(memory: &CommonMemory, task: u32) -> Steps {
    let step = |process: &ProcessId| {
        let number = memory.command_number(*process).unwrap_or(task);
        (memory.header(*process).step, (*process != ProcessId::T3i).then_some(number))
    };
    ProcessId::ALL.iter().map(step).collect()
}

/// Step and last fired row of each process.
pub fn state(memory: &CommonMemory) -> Vec<(Option<Name16>, Option<Decided>)> {
    let of = |process: &ProcessId| {
        let header = memory.header(*process);
        (header.step, header.decided)
    };
    ProcessId::ALL.iter().map(of).collect()
}

/// The outputs of the controller's processes and of the devices that execute lines, without the line to the robot.
fn outputs(branch: &Branch<'_>) -> (DeviceOutputs, Vec<OutWords>) {
    let words = DeviceOutputs { link_tx: LinkBytes::default(), ..branch.closed.outputs() };
    (words, branch.field().map_or_else(Vec::new, SimulatedField::images))
}

#[must_use]
pub fn emulator(facility: &Facility) -> Hwsc {
    Hwsc::new(facility.job.steps.clone(), TIME_LIMIT)
}

impl Parent {
    /// Run the job to its end. Fails with [`Error`] if the undisturbed job does not finish.
    pub fn run(facility: &Facility) -> Result<Self, Error> {
        let mut branch = Branch::start(facility)?;
        let mut hwsc = emulator(facility);
        let mut parent = Self {
            begun: Vec::new(),
            worlds: Vec::new(),
            changes: Vec::new(),
            outputs: Vec::new(),
            states: Vec::new(),
            ticks: 0,
            digest: String::new(),
        };
        let mut before = steps(branch.memory(), 0);
        let mut written = outputs(&branch);
        let mut known = HashSet::new();
        loop {
            branch.step(&mut hwsc);
            let tick = branch.at();
            while parent.begun.len() < hwsc.begun_steps().len() {
                if !parent.begun.is_empty() {
                    parent.worlds.push(World::of(&mut branch));
                }
                parent.begun.push(tick);
            }
            let now = steps(branch.memory(), branch.closed.external().hws.number);
            if now != before {
                parent.changes.push(tick.0);
                before = now;
            }
            let writes = outputs(&branch);
            if writes != written {
                parent.outputs.push(tick.0);
                written = writes;
            }
            if known.insert(state(branch.memory())) {
                parent.states.push(tick.0);
            }
            match hwsc.progress() {
                Progress::Running => {}
                Progress::Over => {
                    parent.worlds.push(World::of(&mut branch));
                    (parent.ticks, parent.digest) = (tick.0, branch.closed.digest().to_string());
                    return Ok(parent);
                }
                Progress::Failed(failure) => return Err(failed(facility, tick, failure)),
            }
        }
    }

    /// The line that is executed after a tick, and the tick in which it began.
    #[must_use]
    pub fn line_at(&self, tick: Tick) -> (usize, Tick) {
        let line = self.begun.iter().rposition(|began| *began <= tick).unwrap_or(0);
        (line, self.begun.get(line).copied().unwrap_or(tick))
    }

    /// The tick in which a line has ended; for the last one, or one after it, the end of the job.
    #[must_use]
    pub fn end_of(&self, line: usize) -> Tick {
        let next = line.checked_add(1).and_then(|next| self.begun.get(next));
        next.copied().unwrap_or(Tick(self.ticks))
    }

    #[must_use]
    pub fn world_after(&self, line: usize) -> Option<&World> {
        self.worlds.get(line)
    }

    #[must_use]
    pub fn forks(&self, ticks: &Ticks) -> Vec<u64> {
        let every = |step: u64| (1..).map(move |n| n * step).take_while(|tick| *tick < self.ticks);
        let changes =
            || self.changes.iter().flat_map(|tick| *tick..=tick + 2).filter(|tick| *tick < self.ticks);
        let mut forks: Vec<u64> = match ticks {
            Ticks::Every(step) => every(*step).collect(),
            Ticks::At(ticks) => ticks.iter().copied().filter(|tick| *tick < self.ticks).collect(),
            Ticks::Changes => changes().collect(),
            Ticks::States => self.states.clone(),
            Ticks::Outputs(_) => {
                let near = |tick: &u64| tick.saturating_sub(NEAR).max(1)..=*tick + NEAR;
                self.outputs.iter().flat_map(near).filter(|tick| *tick < self.ticks).collect()
            }
            Ticks::Both(step) => every(*step).chain(changes()).collect(),
        };
        forks.sort_unstable();
        forks.dedup();
        if let Ticks::Outputs(every) = ticks {
            let mut place = 0;
            forks.retain(|_| {
                place += 1;
                (place - 1) % every == 0
            });
        }
        forks
    }
}

fn failed(facility: &Facility, tick: Tick, failure: &JobFailure) -> Error {
    Error::Campaign(format!("{} fails undisturbed, at tick {}: {failure}", facility.job.name, tick.0))
}
