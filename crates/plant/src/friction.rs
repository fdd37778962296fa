//! Friction of a flat pad on a face: its effect on sliding and turning within a time step.
//!
//! Force and moment of friction share one limit, an ellipse, and act against the motion at the end of the step. This is
//! a monotonic equation for the impulse per unit of remaining speed, solved by bisection.

use rapier3d_f64::math::Real;

const ROUNDS: u32 = 60; // number of bisections: more than the bits of a number

/// Motion of a body in the plane of the pads, at its middle: m/s, and rad/s about the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Along the line from the middle to the pads.
    pub along: Real,
    /// Across that line, in the direction in which a positive turn moves the touched area.
    pub across: Real,
    pub turn: Real,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchedBody {
    pub mass: Real,    // kg
    pub inertia: Real, // moment of inertia about the normal, kg·m²
    pub reach: Real,   // distance from the middle of the body to that of the touched area, m
    pub arm: Real,     // lever arm of friction on the touched area, m
}

impl TouchedBody {
    /// The motion after a step with an impulse of up to `limit` (N·s); `None` if friction stops the body.
    #[must_use]
    pub fn after(&self, motion: &Motion, limit: Real) -> Option<Motion> {
        let stop = [self.mass * motion.along, self.mass * motion.across];
        let moment = self.inertia * motion.turn - self.reach * stop[1];
        let needed = libm::hypot(libm::hypot(stop[0], stop[1]), moment / self.arm);
        if needed <= limit {
            return None;
        }
        let (mut low, mut high) = (0.0, 1.0);
        while high * self.speed(&self.damped(motion, high)) < limit && high < 1e15 {
            high *= 4.0;
        }
        for _ in 0..ROUNDS {
            let middle = 0.5 * (low + high);
            if middle * self.speed(&self.damped(motion, middle)) < limit {
                low = middle
            } else {
                high = middle
            }
        }
        Some(self.damped(motion, low))
    }

    /// Speed of the touched area, combined from sliding and from turning at its lever arm.
    fn speed(&self, motion: &Motion) -> Real {
        let point = libm::hypot(motion.along, motion.across + motion.turn * self.reach);
        libm::hypot(point, motion.turn * self.arm)
    }

    fn damped(&self, motion: &Motion, impulse: Real) -> Motion {
        let (by_mass, by_inertia) = (impulse / self.mass, impulse / self.inertia);
        let (a, b) = (1.0 + by_mass, by_mass * self.reach);
        let (c, d) =
            (by_inertia * self.reach, 1.0 + by_inertia * (self.arm * self.arm + self.reach * self.reach));
        let determinant = a * d - b * c;
        Motion {
            along: motion.along / a,
            across: (motion.across * d - motion.turn * b) / determinant,
            turn: (motion.turn * a - motion.across * c) / determinant,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BAR: TouchedBody = TouchedBody { mass: 0.2, inertia: 1.8e-4, reach: 0.0425, arm: 0.005 };

    #[test]
    fn body_within_friction_stays() {
        // Gravity for 2.5 ms needs 0.0049 N·s at the middle: 0.042 at the touched area, mostly as a moment.
        let fall = Motion { along: 0.0, across: -0.0245, turn: 0.0 };
        assert_eq!(BAR.after(&fall, 0.05), None);
        assert!(BAR.after(&fall, 0.03).is_some());
    }

    #[test]
    fn bar_held_at_its_end_droops_and_hardly_slides() {
        let fall = Motion { along: 0.0, across: -0.0245, turn: 0.0 };
        let left = BAR.after(&fall, 0.03).unwrap();
        let point = left.across + left.turn * BAR.reach;
        assert!(left.turn > 0.0 && point.abs() < 0.2 * left.turn * BAR.arm, "{left:?}");
    }

    #[test]
    fn friction_without_a_lever_is_coulomb_friction() {
        let block = TouchedBody { mass: 2.0, inertia: 1.0, reach: 0.0, arm: 0.1 };
        let left = block.after(&Motion { along: 3.0, across: -4.0, turn: 0.0 }, 1.0).unwrap();
        assert!((libm::hypot(left.along, left.across) - (5.0 - 0.5)).abs() < 1e-9, "{left:?}");
        assert!((left.along / left.across + 0.75).abs() < 1e-9);
    }
}
