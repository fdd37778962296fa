//! Limits of TRAJ-PARA and the velocity knob.
//!
//! The manual names the columns of a trajectory form (VII.6) but gives no units, so the three units are ASSUMED; they
//! are defined only here.

use interfaces::device::KNOB_FULL;
use rcs_core::{Plain, tick::TICK_S};

/// in/s per count of `vel-max`. ASSUMED.
const VELOCITY_COUNT: f64 = 0.1;
/// in/s² per count of `acc-fac`: a velocity count per tick (4 is 10 in/s²). ASSUMED.
const ACCELERATION_COUNT: f64 = VELOCITY_COUNT / TICK_S;
/// in/s³ per count of `smooth`: an acceleration count per tick; a larger number is less smoothing (VII.6). ASSUMED.
const JERK_COUNT: f64 = ACCELERATION_COUNT / TICK_S;
/// Greatest velocity on the DEPC link, in/s (A 2.3).
pub const LINK_VELOCITY: f64 = 14.0;

/// Limits along a path, whose inches are those of [`geometry::frame::Distance::path`].
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Limits {
    pub velocity: f64,     // in/s
    pub acceleration: f64, // in/s²
    pub jerk: f64,         // in/s³
}

impl Limits {
    /// The velocity is at most [`LINK_VELOCITY`]. `None` if a count is not positive, since the move would never end.
    #[must_use]
    pub fn from_counts(acc_fac: i32, vel_max: i32, smooth: i32) -> Option<Self> {
        if acc_fac <= 0 || vel_max <= 0 || smooth <= 0 {
            return None;
        }
        Some(Self {
            velocity: (f64::from(vel_max) * VELOCITY_COUNT).min(LINK_VELOCITY),
            acceleration: f64::from(acc_fac) * ACCELERATION_COUNT,
            jerk: f64::from(smooth) * JERK_COUNT,
        })
    }

    /// Half the acceleration and jerk, for each of two superposed motions.
    #[must_use]
    pub fn share(&self) -> Self {
        Self { velocity: self.velocity, acceleration: self.acceleration * 0.5, jerk: self.jerk * 0.5 }
    }

    /// The smaller acceleration and jerk of both, with this velocity.
    #[must_use]
    pub fn within(&self, other: &Self) -> Self {
        Self {
            velocity: self.velocity,
            acceleration: self.acceleration.min(other.acceleration),
            jerk: self.jerk.min(other.jerk),
        }
    }

    /// The velocity at a position of the knob (0 to [`KNOB_FULL`]), in/s.
    #[must_use]
    pub fn velocity_at(&self, knob: u16) -> f64 {
        self.velocity * (f64::from(knob.min(KNOB_FULL)) / f64::from(KNOB_FULL))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_match_the_printed_forms() {
        // VIII.10: a free path is 4/100/8.
        let limits = Limits::from_counts(4, 100, 8).unwrap();
        assert!((limits.velocity - 10.0).abs() < 1e-12);
        assert!((limits.acceleration - 10.0).abs() < 1e-12);
        assert!((limits.jerk - 500.0).abs() < 1e-9);
        assert!((limits.velocity_at(250) - 2.5).abs() < 1e-12);
        assert!((limits.velocity_at(u16::MAX) - 10.0).abs() < 1e-12);
    }

    #[test]
    fn link_limits_the_velocity() {
        assert!((Limits::from_counts(1, i32::MAX, 1).unwrap().velocity - LINK_VELOCITY).abs() < 1e-12);
    }

    #[test]
    fn counts_below_one_are_refused() {
        for (a, v, s) in [(0, 1, 1), (1, 0, 1), (1, 1, 0), (-4, 100, 8), (4, i32::MIN, 8)] {
            assert_eq!(Limits::from_counts(a, v, s), None);
        }
    }
}
