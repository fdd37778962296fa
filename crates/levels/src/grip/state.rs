//! The state of Grip.

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

/// Readings that are kept to report a steady opening and a velocity.
pub(super) const WINDOW: usize = 4;

/// The last readings of the attached gripper.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Sensed {
    /// All words of the last tick.
    pub last: GripSensors,
    /// Counts of the potentiometer, the newest first.
    pub window: [u16; WINDOW],
}

/// What the fingers touch in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Touch {
    /// Not certain: one finger touches, or both do while they move.
    Unclear,
    /// Neither finger touches anything, or they touch each other.
    Free,
    /// Both fingers touch something between them, at rest.
    Both,
}

/// State of Grip.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The command and how far it has come.
    pub execution: Execution,
    /// Step of its table.
    pub step: Step,
    /// Its goal.
    pub goal: GripGoal,
    /// Since when it has not been waiting, or the calibration has been under way.
    pub since: Tick,
    /// Ticks in [`Step::Settle`].
    pub settled: u8,
    /// Ticks below the grasp size without force.
    pub missed: u8,
    /// Step of UP-INIT.
    pub phase: GripPhase,
    /// Scale and offset of the sensors, once they are known, or of the time before a restart.
    pub calibration: Option<Calibration>,
    /// Readings at the closed end, while calibrating.
    pub closed: Readings,
    /// Readings at the open end, while calibrating.
    pub open: Readings,
    /// How long the readings have been steady, while calibrating.
    pub steady: Steady,
    /// The last readings, if the gripper was attached in the last tick.
    pub sensed: Option<Sensed>,
    /// What is between the fingers.
    pub felt: Felt,
    /// What they touched in the last tick.
    pub touch: Touch,
    /// Ticks for which that has been the same.
    pub touch_ticks: u8,
    /// Ticks for which the fingers have stood still.
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
