//! Air supply of a gripper: the flow through its valves.
//!
//! The parts gripper and the pedestal's hand have eight valves, whose flows add up (III.3.6); the v-gripper and the
//! tool gripper have two (VI.4, VI.5). All drive a cylinder ([`crate::gripper::Air`]).

use interfaces::device::{JawValves, valve};

/// Speeds of the six flow valves, in/s, opening positive ([`valve`]).
const FLOWS: [(u8, f64); 6] = [
    (valve::OPEN_FINE, 0.25),
    (valve::OPEN_MEDIUM, 1.0),
    (valve::OPEN_COARSE, 4.0),
    (valve::CLOSE_FINE, -0.25),
    (valve::CLOSE_MEDIUM, -1.0),
    (valve::CLOSE_COARSE, -4.0),
];

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Supply {
    /// Speed of free fingers, in/s, opening positive.
    pub flow: f64,
    /// True if both sides are vented, so that the force goes to zero.
    pub vent: bool,
}

impl Supply {
    /// The flow of eight valves, one bit each.
    #[must_use]
    pub fn of_bits(bits: u8) -> Self {
        let supplied = bits & valve::SUPPLY != 0;
        let flow = FLOWS.iter().filter(|(bit, _)| supplied && bits & bit != 0).map(|(_, flow)| flow).sum();
        Self { flow, vent: bits & valve::VENT != 0 }
    }

    /// The flow of two valves that move free fingers at `speed` in/s; with air on both sides they balance.
    #[must_use]
    pub fn of_jaws(valves: &JawValves, speed: f64) -> Self {
        let flow = match (valves.open, valves.close) {
            (true, false) => speed,
            (false, true) => -speed,
            _ => 0.0,
        };
        Self { flow, vent: false }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flows_add_up_with_supply() {
        let bits = valve::OPEN_COARSE | valve::OPEN_FINE | valve::CLOSE_MEDIUM;
        assert_eq!(Supply::of_bits(valve::SUPPLY | bits), Supply { flow: 3.25, vent: false });
        assert_eq!(Supply::of_bits(bits), Supply::default());
        assert!(Supply::of_bits(valve::VENT).vent);
    }

    #[test]
    fn two_valves_open_close_or_balance() {
        let flow = |open, close| Supply::of_jaws(&JawValves { open, close }, 2.0).flow;
        assert_eq!(
            [flow(true, false), flow(false, true), flow(true, true), flow(false, false)],
            [2.0, -2.0, 0.0, 0.0]
        );
    }
}
