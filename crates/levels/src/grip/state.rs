use interfaces::{
    device::GripSensors,
    grip::{Calibration, Felt},
};
use rcs_core::{Actions, Plain, tick::Tick};

use super::{
    calibration::{Readings, Steady},
    goal::GripGoal,
    tables::{GripPhase, Step},
};
use crate::execution::Execution;

/// Stored readings, for a steady opening and a velocity.
pub(super) const WINDOW: usize = 4;

/// The last readings of the attached gripper.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Sensed {
    /// All words of the last tick.
    pub last: GripSensors,
    /// Counts of the potentiometer, the newest first.
    pub window: [u16; WINDOW],
}

/// Contact of the fingers in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Touch {
    /// Not certain: one finger touches, or both do while they move.
    Unclear,
    /// Neither finger touches an object, or they touch each other.
    Free,
    /// Both fingers touch an object at rest.
    Both,
}

/// State of Grip.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The command and its progress.
    pub execution: Execution,
    /// Step of its table.
    pub step: Step,
    /// Its goal.
    pub goal: GripGoal,
    /// Start of its execution after a wait, or of the calibration.
    pub since: Tick,
    /// Ticks in [`Step::Settle`].
    pub settled: u8,
    /// Ticks below the grasp size without force.
    pub missed: u8,
    /// Step of UP-INIT.
    pub phase: GripPhase,
    /// Scale and offset of the sensors, from a calibration or from before a restart.
    pub calibration: Option<Calibration>,
    /// Readings at the closed end, while calibrating.
    pub closed: Readings,
    /// Readings at the open end, while calibrating.
    pub open: Readings,
    /// Duration of steady readings, while calibrating.
    pub steady: Steady,
    /// The last readings, if the gripper was attached in the previous tick.
    pub sensed: Option<Sensed>,
    /// What is between the fingers.
    pub felt: Felt,
    /// Their contact in the previous tick.
    pub touch: Touch,
    /// Ticks with the same contact.
    pub touch_ticks: u8,
    /// Ticks for which the fingers have been at rest.
    pub still_ticks: u8,
    /// Command bits to the valves.
    pub valves: u8,
}

impl State {
    /// A calibration, or an opening without one, is under way.
    #[must_use]
    pub fn is_calibrating(&self) -> bool {
        matches!(
            self.phase,
            GripPhase::Closing | GripPhase::Opening | GripPhase::Venting | GripPhase::Widening
        )
    }
}
