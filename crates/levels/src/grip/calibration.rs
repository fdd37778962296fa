//! Conversion from counts to inches and pounds: scale and offset of the sensors, measured by UP-INIT.

use interfaces::{
    device::{ADC_FULL_SCALE, GripSensors},
    grip::{Calibration, Scale},
};
use rcs_core::Plain;

use super::goal::{CLOSED_END, OPEN_END, SUPPLY_FORCE};

const STEADY_COUNTS: u16 = 6; // counts: above the noise, below a fine flow
const LEAST_TRAVEL: f64 = 1000.0; // counts between the ends of travel
const LEAST_STRAIN: f64 = 400.0; // counts between supply force and no force

/// The line through a value at some counts and another at `span` counts more.
fn through(counts: f64, value: f64, span: f64, further: f64) -> Scale {
    let gain = (further - value) / span;
    Scale { zero: counts - value / gain, gain }
}

pub(super) fn value(scale: &Scale, counts: f64) -> f64 {
    (counts - scale.zero) * scale.gain
}

/// Steady readings, counts.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Readings {
    pub potentiometer: f64,
    pub left: f64,
    pub right: f64,
}

/// Sums of counts over the ticks since the readings have been steady.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Steady {
    pub ticks: u32,
    pub potentiometer: u32,
    pub left: u32,
    pub right: u32,
}

/// `free` are readings without force.
pub(super) fn calibration(closed: &Readings, open: &Readings, free: &Readings) -> Calibration {
    let travel = open.potentiometer - closed.potentiometer;
    let (left, right) = (closed.left - free.left, closed.right - free.right);
    Calibration {
        potentiometer: through(closed.potentiometer, CLOSED_END, travel, OPEN_END),
        left: through(free.left, 0.0, left, SUPPLY_FORCE),
        right: through(free.right, 0.0, right, SUPPLY_FORCE),
    }
}

/// True if the readings distinguish the ends of travel, and the supply force from no force, within the converters.
pub(super) fn is_plausible(closed: &Readings, open: &Readings, free: &Readings) -> bool {
    let full = f64::from(ADC_FULL_SCALE);
    let unsaturated = |r: &Readings| r.potentiometer < full && r.left < full && r.right < full;
    open.potentiometer - closed.potentiometer >= LEAST_TRAVEL
        && closed.left - free.left >= LEAST_STRAIN
        && closed.right - free.right >= LEAST_STRAIN
        && unsaturated(closed)
        && unsaturated(open)
}

impl Steady {
    pub(super) fn note(&mut self, now: &GripSensors, before: &GripSensors) {
        let still = |now: u16, before: u16| now.abs_diff(before) <= STEADY_COUNTS;
        let steady = still(now.potentiometer, before.potentiometer)
            && still(now.strain_left, before.strain_left)
            && still(now.strain_right, before.strain_right);
        let sums = if steady { *self } else { Self::default() };
        *self = Self {
            ticks: sums.ticks.saturating_add(1),
            potentiometer: sums.potentiometer.saturating_add(u32::from(now.potentiometer)),
            left: sums.left.saturating_add(u32::from(now.strain_left)),
            right: sums.right.saturating_add(u32::from(now.strain_right)),
        };
    }

    pub(super) fn mean(&self) -> Readings {
        let ticks = f64::from(self.ticks.max(1));
        Readings {
            potentiometer: f64::from(self.potentiometer) / ticks,
            left: f64::from(self.left) / ticks,
            right: f64::from(self.right) / ticks,
        }
    }
}
