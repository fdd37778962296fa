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

pub(super) const WINDOW: usize = 4; // readings, for a steady opening and a velocity

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Sensed {
    pub last: GripSensors,
    pub window: [u16; WINDOW], // counts of the potentiometer, the newest first
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain, Actions)]
pub enum Touch {
    /// Not certain: one finger touches, or both do while they move.
    Unclear,
    /// Neither finger touches an object, or they touch each other.
    Free,
    /// Both fingers touch an object at rest.
    Both,
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    pub execution: Execution,
    pub step: Step,
    pub goal: GripGoal,
    /// Start of the command's execution after a wait, or start of the calibration.
    pub since: Tick,
    pub settled: u8,                      // ticks in Step::Settle
    pub missed: u8,                       // ticks below the grasp size without force
    pub phase: GripPhase,                 // step of UP-INIT
    pub calibration: Option<Calibration>, // may be from before a restart
    pub closed: Readings,                 // at the closed end, while calibrating
    pub open: Readings,                   // at the open end, while calibrating
    pub steady: Steady,
    pub sensed: Option<Sensed>, // `None` unless the gripper was attached in the previous tick
    pub felt: Felt,
    pub touch: Touch, // contact in the previous tick
    pub touch_ticks: u8,
    pub still_ticks: u8,
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
