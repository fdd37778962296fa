//! Conversion from counts to inches and pounds: scale and offset of the sensors, measured by UP-INIT.

use interfaces::{
    device::{ADC_FULL_SCALE, GripSensors},
    grip::{Calibration, Scale},
};
use rcs_core::Plain;

use super::goal::{CLOSED_END, OPEN_END, SUPPLY_FORCE};

/// Greatest difference between consecutive steady readings, counts: above the noise, below a fine flow.
const STEADY_COUNTS: u16 = 6;
/// Least difference of the potentiometer between the ends of travel, counts.
const LEAST_TRAVEL: f64 = 1000.0;
/// Least difference of a strain gage between the supply force and none, counts.
const LEAST_STRAIN: f64 = 400.0;

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

/// From the readings at both ends of travel and without force.
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
    /// Add the readings of a tick; those of the previous tick show whether they are steady.
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
