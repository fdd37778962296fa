//! The parts gripper of tests that need one: its fingers follow the valves.

use interfaces::device::{GripSensors, valve};

/// The fingers of a parts gripper without a part: opening, in, and the force with which they press on each
/// other, lb.
pub struct Fingers {
    /// Opening, in.
    pub opening: f64,
    /// Force, lb.
    pub force: f64,
}

impl Fingers {
    /// A tick with the valves as commanded.
    pub fn advance(&mut self, bits: u8) {
        if bits & valve::VENT != 0 {
            self.force = 0.0;
        }
        if bits & valve::SUPPLY == 0 || bits & valve::VENT != 0 {
            return;
        }
        let flows = [
            (valve::OPEN_FINE, 0.25),
            (valve::OPEN_MEDIUM, 1.0),
            (valve::OPEN_COARSE, 4.0),
            (valve::CLOSE_FINE, -0.25),
            (valve::CLOSE_MEDIUM, -1.0),
            (valve::CLOSE_COARSE, -4.0),
        ];
        let speed: f64 = flows.iter().filter(|(bit, _)| bits & bit != 0).map(|(_, flow)| flow).sum();
        self.opening = (self.opening + speed * 0.04).clamp(0.1, 5.0);
        // Against the closed end the fingers press on each other.
        self.force = if self.opening > 0.1 { 0.0 } else { (self.force - speed * 20.0).clamp(0.0, 80.0) };
    }

    /// What potentiometer and strain gages read.
    pub fn show(&self, sensors: &mut GripSensors) {
        sensors.potentiometer = (200.0 + 700.0 * self.opening) as u16;
        let strain = (100.0 + 40.0 * self.force) as u16;
        (sensors.strain_left, sensors.strain_right) = (strain, strain);
    }
}
