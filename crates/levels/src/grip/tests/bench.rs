//! The Grip process and a simulated gripper, tick by tick.

use geometry::units::hundredths;
use interfaces::{
    CommonMemory, ExternalInputs, GripOutputs,
    device::{QuickChangeSensors, valve},
    grip::{GripCommand, GripReport, GripVerb},
    process::{Inputs, Process},
};
use rcs_core::tick::Tick;

use super::{Grip, gripper::Gripper};
use crate::coverage::Coverage;

const OPEN: u8 = valve::OPEN_COARSE | valve::OPEN_MEDIUM | valve::OPEN_FINE;
pub const CLOSE: u8 = valve::CLOSE_COARSE | valve::CLOSE_MEDIUM | valve::CLOSE_FINE;

/// Process, inputs, plant, and what was seen.
pub struct Bench {
    pub process: Grip,
    pub memory: CommonMemory,
    pub external: ExternalInputs,
    pub gripper: Gripper,
    pub tick: Tick,
    /// Tables and rows that fired.
    pub rows: Coverage,
    /// Valve patterns of the current command in the order in which they came, without repetitions.
    pub patterns: Vec<u8>,
}

impl Bench {
    /// A bench with the gripper attached, after one tick in which nothing was commanded: a command that
    /// stands in the buffer in the first tick is one of the time before a restart.
    pub fn new(gripper: Gripper) -> Self {
        Self::boot(gripper, true)
    }

    /// The same, the gripper being in its holster.
    pub fn without(gripper: Gripper) -> Self {
        Self::boot(gripper, false)
    }

    fn boot(gripper: Gripper, attached: bool) -> Self {
        let mut bench = Self {
            process: Grip::default(),
            memory: CommonMemory::default(),
            external: ExternalInputs::default(),
            gripper,
            tick: Tick::BEFORE_START,
            rows: Coverage::default(),
            patterns: Vec::new(),
        };
        bench.attach(attached);
        bench.step();
        bench
    }

    /// Ticks in which the process is dormant: its outputs are republished.
    pub fn sleep(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick = self.tick.next();
            self.memory.grip.header.stamp = self.tick;
            self.memory.grip.header.republished = true;
            self.gripper.advance(self.memory.grip.valves.bits);
        }
    }

    /// Attach or detach the gripper.
    pub fn attach(&mut self, locked: bool) {
        let end_effector_id = u8::from(locked);
        self.external.devices.quick_change =
            QuickChangeSensors { locked, unlocked: !locked, end_effector_id };
    }

    /// Write a new command; opening in inches, force in pounds.
    pub fn command(&mut self, command: GripVerb, opening: f64, force: i32) {
        self.command_at(command, opening, force, 0);
    }

    /// Write a new command with a speed, 0.01 in/s.
    pub fn command_at(&mut self, command: GripVerb, opening: f64, force: i32, velocity: i32) {
        let number = self.memory.emove.grip.number + 1;
        let position = hundredths(opening);
        self.memory.emove.grip =
            GripCommand { number, command, force, position, velocity, end_effector_id: Some(1) };
        self.patterns.clear();
    }

    /// One tick.
    pub fn step(&mut self) -> GripOutputs {
        self.tick = self.tick.next();
        self.external.devices.grip =
            if self.process.attached(&self.external) { self.gripper.sensors() } else { Default::default() };
        let mut outputs = self.memory.grip;
        let inputs = Inputs { tick: self.tick, memory: &self.memory, external: &self.external, data: &() };
        self.process.step(&inputs, &mut outputs);
        let bits = outputs.valves.bits;
        assert!(bits & OPEN == 0 || bits & CLOSE == 0, "opens and closes at once: {bits:#04x}");
        assert_eq!(bits, outputs.status.valves);
        assert!(self.process.attached(&self.external) || bits == 0, "valves without a gripper: {bits:#04x}");
        self.rows.note(&outputs.header);
        if self.patterns.last() != Some(&bits) {
            self.patterns.push(bits);
        }
        self.gripper.advance(bits);
        self.memory.grip = outputs;
        outputs
    }

    /// Ticks until the command has ended, and how.
    pub fn finish(&mut self) -> (u32, GripOutputs) {
        for ticks in 1..=2000 {
            let outputs = self.step();
            assert_eq!(outputs.status.echo, self.memory.emove.grip.number);
            if !matches!(outputs.status.report, GripReport::Executing | GripReport::Paused) {
                return (ticks, outputs);
            }
        }
        panic!("no end at tick {}: {:?}", self.tick, self.process);
    }

    /// Command and finish; panics unless it is done.
    pub fn done(&mut self, command: GripVerb, opening: f64, force: i32) -> (u32, GripOutputs) {
        self.command(command, opening, force);
        let (ticks, outputs) = self.finish();
        assert_eq!(
            outputs.status.report,
            GripReport::Done,
            "{command} {opening} {force}: {:?}",
            outputs.status
        );
        (ticks, outputs)
    }

    /// Let ticks pass.
    pub fn wait(&mut self, ticks: u32) -> GripOutputs {
        for _ in 0..ticks {
            self.step();
        }
        self.memory.grip
    }
}

impl Grip {
    fn attached(&self, external: &ExternalInputs) -> bool {
        let quick_change = external.devices.quick_change;
        quick_change.locked && quick_change.end_effector_id == 1
    }
}
