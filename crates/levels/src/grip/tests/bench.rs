use geometry::units::hundredths;
use interfaces::{
    CommonMemory, ExternalInputs, GripOutputs,
    device::valve,
    grip::{GripCommand, GripReport, GripVerb},
};
use rcs_core::tick::Tick;

use super::Grip;
use crate::{
    bench::{self, Tested, World},
    environment::{air::Gripper, ring::mated},
};

const OPEN: u8 = valve::OPEN_COARSE | valve::OPEN_MEDIUM | valve::OPEN_FINE;
pub const CLOSE: u8 = valve::CLOSE_COARSE | valve::CLOSE_MEDIUM | valve::CLOSE_FINE;

pub type Bench = bench::Bench<Grip, Gripper>;

fn is_attached(external: &ExternalInputs) -> bool {
    let quick_change = external.devices.quick_change;
    quick_change.locked && quick_change.end_effector_id == 1
}

impl Tested<()> for Grip {
    type Order = GripCommand;
    type End = GripOutputs;
    const LONGEST: u64 = 2000;

    fn order(memory: &mut CommonMemory, order: GripCommand, number: u32) {
        memory.emove.grip = GripCommand { number, ..order };
    }

    fn end(outputs: &GripOutputs) -> Option<GripOutputs> {
        let executes = matches!(outputs.status.report, GripReport::Executing | GripReport::Paused);
        Some(*outputs).filter(|_| !executes)
    }

    fn check(outputs: &GripOutputs, _: &CommonMemory, external: &ExternalInputs) {
        let bits = outputs.valves.bits;
        assert!(bits & OPEN == 0 || bits & CLOSE == 0, "opens and closes at once: {bits:#04x}");
        assert_eq!(bits, outputs.status.valves);
        assert!(is_attached(external) || bits == 0, "valves without a gripper: {bits:#04x}");
    }
}

impl World<Grip> for Gripper {
    fn sense(&mut self, _: Tick, _: &mut CommonMemory, external: &mut ExternalInputs) {
        external.devices.grip = if is_attached(external) { self.sensors() } else { Default::default() };
    }

    fn act(&mut self, _: Tick, _: &CommonMemory, after: &mut CommonMemory, _: &mut ExternalInputs) {
        self.advance(after.grip.valves.bits);
    }
}

impl Bench {
    /// A bench with the gripper attached, after one tick without a command. The process treats a command in its first
    /// tick as an old command from before a restart.
    pub fn new(gripper: Gripper) -> Self {
        Self::boot(gripper, true)
    }

    pub fn without(gripper: Gripper) -> Self {
        Self::boot(gripper, false)
    }

    fn boot(gripper: Gripper, attached: bool) -> Self {
        let mut bench = Self::before(gripper);
        bench.attach(attached);
        bench.step();
        bench
    }

    pub fn attach(&mut self, locked: bool) {
        self.external.devices.quick_change = mated(locked, 1);
    }

    /// Write a new command; opening in inches, force in pounds.
    pub fn command(&mut self, command: GripVerb, opening: f64, force: i32) {
        self.command_at(command, opening, force, 0);
    }

    /// Write a new command with a speed, 0.01 in/s.
    pub fn command_at(&mut self, command: GripVerb, opening: f64, force: i32, velocity: i32) {
        let (number, position, end_effector_id) = (0, hundredths(opening), Some(1));
        self.send(GripCommand { number, command, force, position, velocity, end_effector_id });
        self.world.patterns.clear();
    }

    /// Panics unless the command is done. Returns its ticks and the outputs.
    pub fn done(&mut self, command: GripVerb, opening: f64, force: i32) -> (u64, GripOutputs) {
        self.command(command, opening, force);
        let began = self.tick;
        let outputs = self.finish();
        let status = &outputs.status;
        assert_eq!(status.report, GripReport::Done, "{command} {opening} {force}: {status:?}");
        (self.tick.since(began), outputs)
    }
}
