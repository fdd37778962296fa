//! The last positions sent, as a path, and the distance of a robot from it.
//!
//! A robot lags behind its commands: at 10 in/s and a lag of 0.2 s a sound robot is 2 in behind the newest position,
//! but near zero from the path within the expected lag. That distance grows if it falls farther behind, takes a short
//! cut, or is moved by an external force.

use core::f64::consts::FRAC_1_SQRT_2;

use geometry::{
    frame::{Frame, INCHES_PER_RADIAN},
    kinematics::Arm,
};
use rcs_core::Plain;

use crate::Plate;

/// Positions in a track, one per period.
pub const TRACK_POINTS: usize = 32;
/// Greatest distance from the path, in; for a rotation 2 degrees (docs/design/link.md "Following").
pub const LIMIT_INCHES: f64 = 0.5;
/// Default lag of a robot, ms: two and a half times the 80 ms of the T3's servos.
pub const LAG_MS: u16 = 200;
/// Greatest permitted lag, ms: a track of periods of 40 ms covers it.
pub const MOST_LAG_MS: u16 = 1000;
const READING_PERIODS: usize = 1; // between a sent position and a reading of it

/// Position and tool axes, in: small angles times [`INCHES_PER_RADIAN`], as [`geometry::frame::Distance::path`].
type Coordinates = [f64; 12];

/// The positions sent in the last periods, the newest first.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Track {
    /// The positions; the first `count` are valid, the others zero.
    points: [Plate; TRACK_POINTS],
    count: u8,
}

impl Track {
    /// Start the path at `plate`, a position that the robot has reported.
    pub fn begin(&mut self, plate: Plate) {
        *self = Self::default();
        self.push(plate);
    }

    /// Add the position of a period: the one sent, or the previous one again.
    pub fn push(&mut self, plate: Plate) {
        self.points.rotate_right(1);
        if let Some(newest) = self.points.first_mut() {
            *newest = plate;
        }
        let most = u8::try_from(TRACK_POINTS).unwrap_or(u8::MAX);
        self.count = self.count.saturating_add(1).min(most);
    }

    /// The last position sent; `None` before the first.
    #[must_use]
    pub fn newest(&self) -> Option<&Plate> {
        self.points.iter().take(usize::from(self.count)).next()
    }

    /// Distance of the tool frame `here` (inches, world) from the path within the lag, inches; one radian equals
    /// [`INCHES_PER_RADIAN`]. `here` is read in the period after the newest position. `None` before the first
    /// position.
    #[must_use]
    pub fn distance(&self, here: &Frame, lag_ms: u16, period_ms: u16, arm: &Arm) -> Option<f64> {
        let here = coordinates(here);
        let lag = usize::from(lag_ms.div_ceil(period_ms.max(1)));
        let points = lag.saturating_add(READING_PERIODS).saturating_add(1);
        let sent = self.points.iter().take(usize::from(self.count)).take(points);
        let mut later: Option<(Plate, Coordinates)> = None;
        let mut least: Option<f64> = None;
        for plate in sent {
            // A robot at rest gets the same position again.
            if later.is_some_and(|(later, _)| later == *plate) {
                continue;
            }
            let point = coordinates(&plate.to_tool(arm));
            let square = from_line(&here, &point, &later.map_or(point, |(_, later)| later));
            least = Some(least.map_or(square, |least| least.min(square)));
            later = Some((*plate, point));
        }
        least.map(libm::sqrt)
    }
}

fn coordinates(frame: &Frame) -> Coordinates {
    let mut all = [0.0; 12];
    let weight = INCHES_PER_RADIAN * FRAC_1_SQRT_2;
    let axes = frame.rotation.matrix().iter().map(|axis| axis * weight);
    all.iter_mut().zip(frame.position.iter().copied().chain(axes)).for_each(|(slot, value)| *slot = value);
    all
}

/// Squared distance from the line between two points.
fn from_line(here: &Coordinates, a: &Coordinates, b: &Coordinates) -> f64 {
    let (mut way, mut along, mut square) = (0.0, 0.0, 0.0);
    for ((here, a), b) in here.iter().zip(a).zip(b) {
        let (step, off) = (b - a, here - a);
        way += step * step;
        along += step * off;
        square += off * off;
    }
    let part = if way > 0.0 { (along / way).clamp(0.0, 1.0) } else { 0.0 };
    (square - part * (2.0 * along - part * way)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::{
        frame::{Vector, rotation_by},
        kinematics::{HOME_JOINTS, T3},
    };

    /// HOME, moved by `x` and `y` inches.
    fn at(x: f64, y: f64) -> Frame {
        let home = T3.forward(&HOME_JOINTS);
        Frame { position: home.position + Vector::new(x, y, 0.0), ..home }
    }

    fn words(frame: &Frame) -> Plate {
        Plate::from_tool(frame, &T3, &Plate::default()).unwrap()
    }

    fn track(periods: u32) -> Track {
        let mut track = Track::default();
        track.begin(words(&at(0.0, 0.0)));
        for period in 1..=periods {
            track.push(words(&at(0.4 * f64::from(period), 0.0)));
        }
        track
    }

    fn distance(track: &Track, here: &Frame, lag_ms: u16) -> f64 {
        track.distance(here, lag_ms, 40, &T3).unwrap()
    }

    #[test]
    fn robot_on_its_path_within_the_lag_has_no_distance() {
        let track = track(20);
        for (x, lag, expected) in
            [(8.0, 0, 0.0), (7.6, 0, 0.0), (6.9, 80, 0.0), (6.0, 80, 0.8), (6.0, 160, 0.0), (8.5, 200, 0.5)]
        {
            let found = distance(&track, &at(x, 0.0), lag);
            assert!((found - expected).abs() < 0.02, "{x} in, {lag} ms: {found}");
        }
    }

    #[test]
    fn a_robot_off_the_path_is_at_its_distance_between_two_points_too() {
        let track = track(20);
        for x in [7.2, 7.3, 7.4, 7.5] {
            let found = distance(&track, &at(x, 0.3), 200);
            assert!((found - 0.3).abs() < 0.02, "{x}: {found}");
        }
    }

    #[test]
    fn a_radian_of_rotation_is_treated_as_fourteen_inches() {
        let track = track(3);
        let here = at(1.2, 0.0);
        for angle in [0.01, 0.1] {
            let turned =
                Frame { rotation: rotation_by(&Vector::new(0.0, 0.0, angle)) * here.rotation, ..here };
            let found = distance(&track, &turned, 80);
            assert!((found - 14.0 * angle).abs() < 0.02, "{angle}: {found}");
        }
    }

    #[test]
    fn empty_track_has_no_distance_and_long_track_is_bounded() {
        assert_eq!(Track::default().distance(&at(0.0, 0.0), LAG_MS, 40, &T3), None);
        let track = track(60);
        let oldest = 0.4 * 29.0;
        let found = distance(&track, &at(0.0, 0.0), u16::MAX);
        assert!((found - oldest).abs() < 0.02, "{found}");
        assert!(distance(&track, &at(24.0 - 0.4 * 26.0, 0.0), MOST_LAG_MS) < 0.02, "the greatest lag fits");
        assert_eq!(track.newest(), Some(&words(&at(24.0, 0.0))));
    }
}
