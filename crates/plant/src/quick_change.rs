//! The quick change: the A plate on the wrist with its locking ring, and its position relative to a B plate.
//!
//! Air turns the ring while the control port is enabled; two reflectance sensors detect its ends (VI.2). The ring
//! catches a B plate only if it locks while the plates lie together. The id pins are longer than the play of the
//! plates: they also read a gripper that is not locked (V.2.1 QC-DETACH).

use geometry::frame::{Frame, rotation_vector};
use interfaces::device::QuickChangeValves;
use serde::{Deserialize, Serialize};

use crate::description::QuickChange as Description;

const SEEN: f64 = 0.02; // fraction of the ring's travel at an end within which its sensor detects it
/// Depth to which plates can be pressed together with touching pins, in; more is a collision.
const PRESSED: f64 = 0.30;
/// Greatest angle between the plates at which the pins meet their pads, radians (3 degrees).
const PINS_ANGLE: f64 = 0.052_36;

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Ring {
    place: f64, // Position: 0 unlocked, 1 locked
    travel_time: f64,
}

impl Ring {
    #[must_use]
    pub fn new(description: &Description, locked: bool) -> Self {
        Self { place: f64::from(u8::from(locked)), travel_time: description.travel_time_s }
    }

    /// Apply the air for `dt` seconds. Air on both sides, or on none, does not move the ring.
    pub fn advance(&mut self, dt: f64, valves: &QuickChangeValves) {
        let way = dt / self.travel_time;
        let towards = match (valves.port, valves.lock, valves.unlock) {
            (true, true, false) => way,
            (true, false, true) => -way,
            _ => return,
        };
        self.place = (self.place + towards).clamp(0.0, 1.0);
    }

    /// Distance of the ring beyond the ranges of its two sensors, as a fraction of its travel; negative within range.
    #[must_use]
    pub fn beyond(&self) -> [f64; 2] {
        [1.0 - SEEN - self.place, self.place - SEEN]
    }

    #[must_use]
    pub fn locked(&self) -> bool {
        self.place >= 1.0 - SEEN
    }

    #[must_use]
    pub fn unlocked(&self) -> bool {
        self.place <= SEEN
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Distance of the plates, in; negative if they are pressed together.
    pub apart: f64,
    pub aside: f64, // offset in the plane of the plates, in
    pub angle: f64, // angle between them, radians
}

impl Gap {
    /// The gap between the robot's tool frame and that of a gripper; the plates lie together where the frames coincide.
    #[must_use]
    pub fn between(robot: &Frame, gripper: &Frame) -> Self {
        let gripper = robot.inverse().compose(gripper);
        let at = gripper.position;
        Self { apart: at.x, aside: libm::hypot(at.y, at.z), angle: rotation_vector(&gripper.rotation).norm() }
    }

    /// True if the mating elements are engaged: the id pins touch, and the plates move together sideways.
    #[must_use]
    pub fn engaged(&self, description: &Description) -> bool {
        (-PRESSED..=description.pins_reach).contains(&self.apart)
            && self.aside <= description.pins_play
            && self.angle <= PINS_ANGLE
    }

    /// True if the ring reaches the B plate.
    #[must_use]
    pub fn lies_together(&self, description: &Description) -> bool {
        self.apart.abs() <= description.tolerance
            && self.aside <= description.tolerance
            && self.angle <= description.tolerance_degrees.to_radians()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::CellDescription;
    use geometry::frame::{Vector, rotation_by};

    fn description() -> Description {
        CellDescription::from_toml(include_str!("../../../data/cell.toml")).unwrap().quick_change
    }

    #[test]
    fn ring_moves_with_port_and_air_and_is_sensed_at_its_ends() {
        let mut ring = Ring::new(&description(), true);
        let unlock = QuickChangeValves { unlock: true, port: true, lock: false };
        ring.advance(10.0, &QuickChangeValves { port: false, ..unlock });
        assert!(ring.locked(), "the port is disabled");
        ring.advance(10.0, &QuickChangeValves { lock: true, ..unlock });
        assert!(ring.locked(), "air on both sides");
        ring.advance(description().travel_time_s / 2.0, &unlock);
        assert!(!ring.locked() && !ring.unlocked(), "neither while between");
        ring.advance(description().travel_time_s, &unlock);
        assert!(ring.unlocked() && !ring.locked());
    }

    #[test]
    fn plates_lie_together_within_their_tolerance() {
        let (quick_change, robot) = (description(), Frame::identity());
        let at = |x: f64, y: f64, degrees: f64| {
            let turned = robot.turned(&rotation_by(&Vector::new(0.0, degrees.to_radians(), 0.0)));
            let gap = Gap::between(&robot, &turned.shifted(Vector::new(x, y, 0.0)));
            (gap.engaged(&quick_change), gap.lies_together(&quick_change))
        };
        assert_eq!(at(0.04, 0.04, 0.5), (true, true));
        assert_eq!(at(0.60, 0.0, 0.0), (true, false), "dropped: the pins still touch");
        assert_eq!(at(0.0, 0.0, 1.5), (true, false));
        assert_eq!(at(0.70, 0.0, 0.0), (false, false));
        assert_eq!(at(0.0, 0.2, 0.0), (false, false));
    }
}
