//! A switching sensor with hysteresis: it switches on at one distance and off at a greater one.

use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq, Serialize)]
pub struct Switch(bool);

impl Switch {
    /// Update with the distance `beyond` the range, negative within it.
    pub fn see(&mut self, beyond: f64, hysteresis: f64) -> bool {
        self.0 = beyond <= if self.0 { hysteresis } else { 0.0 };
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn switch_turns_off_later_than_on() {
        let mut switch = Switch::default();
        let seen = [0.02, 0.0, 0.02, 0.03, 0.04, 0.02, -0.1].map(|beyond| switch.see(beyond, 0.03));
        assert_eq!(seen, [false, true, true, true, false, false, true]);
    }
}
