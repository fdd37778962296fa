//! What Grip remembers from tick to tick.

use rcs_core::{
    Plain,
    interface::{
        device::GripSensors,
        grip::{GripCommand, GripVerb},
    },
    tick::Tick,
    units::inches,
};

use crate::old_execution::Execution;

/// Opening at the closed end of travel, in (VIII.9.1: a closed gripper has 0.10 in).
pub(super) const CLOSED_END: f64 = 0.10;
/// Opening at the open end of travel, in.
pub(super) const OPEN_END: f64 = 5.00;
/// Force on each finger with the whole supply pressure behind it, lb: what the strain gages feel when the fingers are shut
/// on each other. ASSUMED: the pads meet at the closed end of travel.
pub(super) const SUPPLY_FORCE: f64 = 80.0;

/// Readings that are kept to report a steady opening and a velocity.
pub(super) const WINDOW: usize = 4;

/// How far the table of the current command has come: its reference action.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Step {
    /// Not begun.
    Start,
    /// The servo moves the fingers, or presses.
    Move,
    /// Valves are off; the readings settle.
    Settle,
}

/// How far the calibration has come: the reference action of UP-INIT.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Phase {
    /// Never done: begins at once, since the gripper is there when the system is booted (VI.3.1).
    Missing,
    /// Never done, or interrupted: waits for UP-INIT or another command that moves the fingers. So begins a process whose gripper
    /// comes later, which is then still in its holster, and one that was started in the middle of a job: a part may be held.
    Deferred,
    /// The fingers close, until the readings are steady.
    Closing,
    /// The fingers open, until the readings are steady.
    Opening,
    /// The air is let out, until the readings are steady.
    Venting,
    /// Scale and offset of all sensors are known.
    Valid,
    /// The last attempt failed; the next command that moves the fingers tries again.
    Failed,
}

/// A sensor that is linear: `value = (counts - zero) * gain`.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Scale {
    /// Counts at value 0.
    pub zero: f64,
    /// Inches or pounds a count.
    pub gain: f64,
}

impl Scale {
    /// The line through a value at some counts and another at `span` counts more.
    pub(super) fn through(counts: f64, value: f64, span: f64, further: f64) -> Self {
        let gain = (further - value) / span;
        Self { zero: counts - value / gain, gain }
    }

    /// Inches or pounds.
    pub(super) fn value(&self, counts: f64) -> f64 {
        (counts - self.zero) * self.gain
    }
}

/// Scale and offset of each sensor, found by UP-INIT.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Calibration {
    /// Potentiometer: inches.
    pub potentiometer: Scale,
    /// Left strain gage: pounds.
    pub left: Scale,
    /// Right strain gage: pounds.
    pub right: Scale,
}

/// Steady readings, counts.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Readings {
    /// Potentiometer.
    pub potentiometer: f64,
    /// Left strain gage.
    pub left: f64,
    /// Right strain gage.
    pub right: f64,
}

/// Sums over the ticks since the readings have been steady.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Steady {
    /// Ticks in the sums.
    pub ticks: u32,
    /// Sum of the potentiometer's counts.
    pub potentiometer: u32,
    /// Sum of the left strain gage's counts.
    pub left: u32,
    /// Sum of the right strain gage's counts.
    pub right: u32,
}

impl Steady {
    /// The mean of the steady readings.
    pub(super) fn mean(&self) -> Readings {
        let ticks = f64::from(self.ticks.max(1));
        Readings {
            potentiometer: f64::from(self.potentiometer) / ticks,
            left: f64::from(self.left) / ticks,
            right: f64::from(self.right) / ticks,
        }
    }
}

/// The command that is being executed: a copy, because the buffer of a commander that restarts is empty.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Command {
    /// What to do.
    pub verb: GripVerb,
    /// Opening, or the grasp size, in.
    pub opening: f64,
    /// Force, lb.
    pub force: f64,
    /// Speed, in/s; 0 means full speed.
    pub speed: f64,
    /// For which gripper; 0 if the commander did not say.
    pub end_effector_id: u8,
}

impl From<&GripCommand> for Command {
    fn from(command: &GripCommand) -> Self {
        Self {
            verb: command.command,
            opening: inches(command.position),
            force: f64::from(command.force),
            speed: inches(command.velocity),
            end_effector_id: command.end_effector_id,
        }
    }
}

/// Everything that Grip remembers.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The current command number, its outcome and its step.
    pub execution: Execution,
    /// The current command.
    pub command: Command,
    /// When the table of the command, or that of the calibration, was consulted first.
    pub since: Tick,
    /// Ticks in [`Step::Settle`].
    pub settled: u8,
    /// Ticks below the grasp size without force.
    pub missed: u8,
    /// How far the calibration has come.
    pub phase: Phase,
    /// Scale and offset of the sensors; zero before the first calibration.
    pub calibration: Calibration,
    /// Readings at the closed end, while calibrating.
    pub closed: Readings,
    /// Readings at the open end, while calibrating.
    pub open: Readings,
    /// How long the readings have been steady, while calibrating.
    pub steady: Steady,
    /// The gripper was attached in the last tick.
    pub attached: bool,
    /// Readings of the last tick.
    pub last: GripSensors,
    /// Potentiometer readings of the last ticks, the newest first.
    pub window: [u16; WINDOW],
    /// Command bits to the valves.
    pub valves: u8,
}

impl State {
    /// The reference action of the current command's table.
    pub(super) fn step(&self) -> Step {
        Step::from_code(self.execution.step).unwrap_or_default()
    }

    /// A calibration is under way.
    pub(super) fn calibrating(&self) -> bool {
        matches!(self.phase, Phase::Closing | Phase::Opening | Phase::Venting)
    }
}
