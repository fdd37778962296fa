//! Air valves by name, and the effect of stuck valves on the outputs.

use interfaces::device::{DeviceOutputs, valve};
use serde::{Deserialize, Serialize};

/// A valve: its index in the list of all.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Valve(u8);

/// The output that drives a valve.
#[derive(Clone, Copy)]
enum Output {
    /// A bit of the eight valves of the parts gripper.
    Grip(u8),
    /// A bit of the eight valves of the pedestal's hand.
    Hand(u8),
    VOpen,
    VClose,
    ToolOpen,
    ToolClose,
    Lock,
    Unlock,
    Port,
}

/// All valves.
const VALVES: [(&str, Output); 23] = [
    ("grip.open-fine", Output::Grip(valve::OPEN_FINE)),
    ("grip.open-medium", Output::Grip(valve::OPEN_MEDIUM)),
    ("grip.open-coarse", Output::Grip(valve::OPEN_COARSE)),
    ("grip.close-fine", Output::Grip(valve::CLOSE_FINE)),
    ("grip.close-medium", Output::Grip(valve::CLOSE_MEDIUM)),
    ("grip.close-coarse", Output::Grip(valve::CLOSE_COARSE)),
    ("grip.vent", Output::Grip(valve::VENT)),
    ("grip.supply", Output::Grip(valve::SUPPLY)),
    ("v.open", Output::VOpen),
    ("v.close", Output::VClose),
    ("tool.open", Output::ToolOpen),
    ("tool.close", Output::ToolClose),
    ("quick-change.lock", Output::Lock),
    ("quick-change.unlock", Output::Unlock),
    ("quick-change.port", Output::Port),
    ("pedestal.open-fine", Output::Hand(valve::OPEN_FINE)),
    ("pedestal.open-medium", Output::Hand(valve::OPEN_MEDIUM)),
    ("pedestal.open-coarse", Output::Hand(valve::OPEN_COARSE)),
    ("pedestal.close-fine", Output::Hand(valve::CLOSE_FINE)),
    ("pedestal.close-medium", Output::Hand(valve::CLOSE_MEDIUM)),
    ("pedestal.close-coarse", Output::Hand(valve::CLOSE_COARSE)),
    ("pedestal.vent", Output::Hand(valve::VENT)),
    ("pedestal.supply", Output::Hand(valve::SUPPLY)),
];

impl Valve {
    /// The valve with a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let at = VALVES.iter().position(|(known, _)| *known == name)?;
        u8::try_from(at).ok().map(Self)
    }

    /// All valves.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..).take(VALVES.len()).map(Self)
    }

    const fn entry(self) -> &'static (&'static str, Output) {
        &VALVES[self.0 as usize]
    }

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.entry().0
    }

    /// Set this valve in the outputs as stuck open or closed.
    pub const fn stick(self, outputs: &mut DeviceOutputs, open: bool) {
        match self.entry().1 {
            Output::Grip(mask) => bit_to(&mut outputs.grip.bits, mask, open),
            Output::Hand(mask) => bit_to(&mut outputs.pedestal_hand.bits, mask, open),
            Output::VOpen => outputs.v_grip.open = open,
            Output::VClose => outputs.v_grip.close = open,
            Output::ToolOpen => outputs.tool_grip.open = open,
            Output::ToolClose => outputs.tool_grip.close = open,
            Output::Lock => outputs.quick_change.lock = open,
            Output::Unlock => outputs.quick_change.unlock = open,
            Output::Port => outputs.quick_change.port = open,
        }
    }
}

const fn bit_to(bits: &mut u8, mask: u8, on: bool) {
    *bits = if on { *bits | mask } else { *bits & !mask };
}

/// Remove the air supply: nothing flows in, and air trapped behind the closed valves of a hand stays. The check valves
/// of v-gripper and tool gripper, whose air stays on while they hold, keep their air too (ASSUMED). Venting needs no
/// supply.
pub const fn cut_air(outputs: &mut DeviceOutputs) {
    outputs.grip.bits &= valve::VENT;
    outputs.pedestal_hand.bits &= valve::VENT;
    (outputs.v_grip.open, outputs.v_grip.close) = (false, false);
    (outputs.tool_grip.open, outputs.tool_grip.close) = (false, false);
    (outputs.quick_change.lock, outputs.quick_change.unlock) = (false, false);
}

/// Hold the locking ring: it does not follow the air.
pub const fn hold_ring(outputs: &mut DeviceOutputs) {
    outputs.quick_change.port = false;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_valve_is_found_by_its_name_and_sticks_alone() {
        let mut all = DeviceOutputs::default();
        for valve in Valve::all() {
            assert_eq!(Valve::named(valve.name()), Some(valve));
            let mut outputs = DeviceOutputs::default();
            valve.stick(&mut outputs, true);
            assert_ne!(outputs, DeviceOutputs::default(), "{}", valve.name());
            valve.stick(&mut outputs, false);
            assert_eq!(outputs, DeviceOutputs::default(), "{}", valve.name());
            let before = all;
            valve.stick(&mut all, true);
            assert_ne!(all, before, "{} has the output of another valve", valve.name());
        }
    }

    #[test]
    fn without_air_only_venting_is_left() {
        let mut outputs = DeviceOutputs::default();
        Valve::all().for_each(|valve| valve.stick(&mut outputs, true));
        cut_air(&mut outputs);
        assert_eq!((outputs.grip.bits, outputs.pedestal_hand.bits), (valve::VENT, valve::VENT));
        assert!(!outputs.v_grip.close && !outputs.tool_grip.close && !outputs.quick_change.unlock);
    }
}
