//! Air valves by name, and the effect of stuck valves on the outputs.

use interfaces::device::{DeviceOutputs, valve};
use serde::{Deserialize, Serialize};

use crate::sensor::Word::{self, Bits, Flag};

/// A valve: its index in the list of all.
#[derive(Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub struct Valve(u8);

/// Name of a valve, and the output that drives it.
type Row = (&'static str, fn(&mut DeviceOutputs) -> Word<'_>);

/// All valves.
const VALVES: [Row; 23] = [
    ("grip.open-fine", |outputs| Bits(&mut outputs.grip.bits, valve::OPEN_FINE)),
    ("grip.open-medium", |outputs| Bits(&mut outputs.grip.bits, valve::OPEN_MEDIUM)),
    ("grip.open-coarse", |outputs| Bits(&mut outputs.grip.bits, valve::OPEN_COARSE)),
    ("grip.close-fine", |outputs| Bits(&mut outputs.grip.bits, valve::CLOSE_FINE)),
    ("grip.close-medium", |outputs| Bits(&mut outputs.grip.bits, valve::CLOSE_MEDIUM)),
    ("grip.close-coarse", |outputs| Bits(&mut outputs.grip.bits, valve::CLOSE_COARSE)),
    ("grip.vent", |outputs| Bits(&mut outputs.grip.bits, valve::VENT)),
    ("grip.supply", |outputs| Bits(&mut outputs.grip.bits, valve::SUPPLY)),
    ("v.open", |outputs| Flag(&mut outputs.v_grip.open)),
    ("v.close", |outputs| Flag(&mut outputs.v_grip.close)),
    ("tool.open", |outputs| Flag(&mut outputs.tool_grip.open)),
    ("tool.close", |outputs| Flag(&mut outputs.tool_grip.close)),
    ("quick-change.lock", |outputs| Flag(&mut outputs.quick_change.lock)),
    ("quick-change.unlock", |outputs| Flag(&mut outputs.quick_change.unlock)),
    ("quick-change.port", |outputs| Flag(&mut outputs.quick_change.port)),
    ("pedestal.open-fine", |outputs| Bits(&mut outputs.pedestal_hand.bits, valve::OPEN_FINE)),
    ("pedestal.open-medium", |outputs| Bits(&mut outputs.pedestal_hand.bits, valve::OPEN_MEDIUM)),
    ("pedestal.open-coarse", |outputs| Bits(&mut outputs.pedestal_hand.bits, valve::OPEN_COARSE)),
    ("pedestal.close-fine", |outputs| Bits(&mut outputs.pedestal_hand.bits, valve::CLOSE_FINE)),
    ("pedestal.close-medium", |outputs| Bits(&mut outputs.pedestal_hand.bits, valve::CLOSE_MEDIUM)),
    ("pedestal.close-coarse", |outputs| Bits(&mut outputs.pedestal_hand.bits, valve::CLOSE_COARSE)),
    ("pedestal.vent", |outputs| Bits(&mut outputs.pedestal_hand.bits, valve::VENT)),
    ("pedestal.supply", |outputs| Bits(&mut outputs.pedestal_hand.bits, valve::SUPPLY)),
];

impl Valve {
    /// The valve with a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|valve| valve.name() == name)
    }

    /// All valves.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..).take(VALVES.len()).map(Self)
    }

    const fn row(self) -> &'static Row {
        &VALVES[self.0 as usize]
    }

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.row().0
    }

    /// Set this valve in the outputs as stuck open or closed.
    pub fn stick(self, outputs: &mut DeviceOutputs, open: bool) {
        self.row().1(outputs).write(open.into());
    }
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
