//! The limits that every point and every target is checked against.

use crate::{Error, Pose, pose::norm};

const ROUNDING: f64 = 1e-6; // relative

/// Limits of targets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Greatest speed of the tool, mm/s.
    pub speed: f64,
    /// Greatest angular speed of the tool, rad/s.
    pub turn: f64,
    /// Least and greatest coordinates of the tool in the work object, mm.
    pub space: [[f64; 3]; 2],
}

impl Limits {
    /// Limits of speed only; the work space is unlimited.
    #[must_use]
    pub const fn of_speed(speed: f64, turn: f64) -> Self {
        Self { speed, turn, space: [[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]] }
    }

    /// Checks a motion that takes `seconds`. Errors: [`Error::TooFast`] or [`Error::Outside`].
    pub fn check(&self, from: &Pose, to: &Pose, seconds: f64) -> Result<(), Error> {
        let way = from.way_to(to);
        let (speed, turn) = (norm(&way.linear) / seconds, norm(&way.angular) / seconds);
        let within = |value: f64, limit: f64| value <= limit * (1.0 + ROUNDING);
        if !(within(speed, self.speed) && within(turn, self.turn)) {
            return Err(Error::TooFast { speed, turn });
        }
        let [low, high] = self.space;
        for (axis, (found, (low, high))) in to.position.into_iter().zip(low.into_iter().zip(high)).enumerate()
        {
            if !(low..=high).contains(&found) {
                return Err(Error::Outside { axis, found });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::from_rotation_vector;

    #[test]
    fn speed_turn_and_space_have_their_limits() {
        let limits = Limits { space: [[-10.0; 3], [10.0; 3]], ..Limits::of_speed(100.0, 1.0) };
        let to = |x: f64, turn: f64| Pose {
            position: [x, 0.0, 0.0],
            orientation: from_rotation_vector(&[0.0, turn, 0.0]),
        };
        let check = |x, turn| limits.check(&Pose::IDENTITY, &to(x, turn), 0.04);
        assert_eq!(check(4.0, 0.04), Ok(()));
        assert!(matches!(check(4.01, 0.0), Err(Error::TooFast { .. })));
        assert!(matches!(check(0.0, 0.041), Err(Error::TooFast { .. })));
        assert!(matches!(check(f64::NAN, 0.0), Err(Error::TooFast { .. })));
        let slow = limits.check(&to(9.0, 0.0), &to(10.5, 0.0), 0.04);
        assert_eq!(slow, Err(Error::Outside { axis: 0, found: 10.5 }));
        assert!(matches!(limits.check(&to(0.0, 0.0), &to(0.0, 0.0), 0.0), Err(Error::TooFast { .. })));
    }
}
