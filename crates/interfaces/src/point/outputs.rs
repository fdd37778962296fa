//! The words that the controller writes.

use core::ops::RangeInclusive;

use Group::{Grip, Joystick, Pedestal, QuickChange, Table, Tool, V};

use super::{
    Group,
    Word::{self, Bits, Count, Flag, Long, Order},
};
use crate::device::{DeviceOutputs, joystick_frame, valve};

/// A word that the controller writes.
#[derive(Clone, Copy, Debug)]
pub struct Output(&'static Row);

type Row = (&'static str, Group, RangeInclusive<i64>, fn(&mut DeviceOutputs) -> Word<'_>);

const BIT: RangeInclusive<i64> = 0..=1;
const NUMBER: RangeInclusive<i64> = 0..=0xFFFF_FFFF; // of an order
const ORDER: RangeInclusive<i64> = 0..=3;
const COUNT: RangeInclusive<i64> = -0x8000_0000..=0x7FFF_FFFF;

static OUTPUTS: [Row; 30] = [
    ("grip.open-fine", Grip, BIT, |d| Bits(&mut d.grip.bits, valve::OPEN_FINE)),
    ("grip.open-medium", Grip, BIT, |d| Bits(&mut d.grip.bits, valve::OPEN_MEDIUM)),
    ("grip.open-coarse", Grip, BIT, |d| Bits(&mut d.grip.bits, valve::OPEN_COARSE)),
    ("grip.close-fine", Grip, BIT, |d| Bits(&mut d.grip.bits, valve::CLOSE_FINE)),
    ("grip.close-medium", Grip, BIT, |d| Bits(&mut d.grip.bits, valve::CLOSE_MEDIUM)),
    ("grip.close-coarse", Grip, BIT, |d| Bits(&mut d.grip.bits, valve::CLOSE_COARSE)),
    ("grip.vent", Grip, BIT, |d| Bits(&mut d.grip.bits, valve::VENT)),
    ("grip.supply", Grip, BIT, |d| Bits(&mut d.grip.bits, valve::SUPPLY)),
    ("v.open", V, BIT, |d| Flag(&mut d.v_grip.open)),
    ("v.close", V, BIT, |d| Flag(&mut d.v_grip.close)),
    ("tool.open", Tool, BIT, |d| Flag(&mut d.tool_grip.open)),
    ("tool.close", Tool, BIT, |d| Flag(&mut d.tool_grip.close)),
    ("quick-change.lock", QuickChange, BIT, |d| Flag(&mut d.quick_change.lock)),
    ("quick-change.unlock", QuickChange, BIT, |d| Flag(&mut d.quick_change.unlock)),
    ("quick-change.port", QuickChange, BIT, |d| Flag(&mut d.quick_change.port)),
    ("pedestal.open-fine", Pedestal, BIT, |d| Bits(&mut d.pedestal_hand.bits, valve::OPEN_FINE)),
    ("pedestal.open-medium", Pedestal, BIT, |d| Bits(&mut d.pedestal_hand.bits, valve::OPEN_MEDIUM)),
    ("pedestal.open-coarse", Pedestal, BIT, |d| Bits(&mut d.pedestal_hand.bits, valve::OPEN_COARSE)),
    ("pedestal.close-fine", Pedestal, BIT, |d| Bits(&mut d.pedestal_hand.bits, valve::CLOSE_FINE)),
    ("pedestal.close-medium", Pedestal, BIT, |d| Bits(&mut d.pedestal_hand.bits, valve::CLOSE_MEDIUM)),
    ("pedestal.close-coarse", Pedestal, BIT, |d| Bits(&mut d.pedestal_hand.bits, valve::CLOSE_COARSE)),
    ("pedestal.vent", Pedestal, BIT, |d| Bits(&mut d.pedestal_hand.bits, valve::VENT)),
    ("pedestal.supply", Pedestal, BIT, |d| Bits(&mut d.pedestal_hand.bits, valve::SUPPLY)),
    ("joystick.led.world", Joystick, BIT, |d| Bits(&mut d.joystick_leds, joystick_frame::WORLD)),
    ("joystick.led.tool", Joystick, BIT, |d| Bits(&mut d.joystick_leds, joystick_frame::TOOL)),
    ("joystick.led.tool-origin", Joystick, BIT, |d| Bits(&mut d.joystick_leds, joystick_frame::TOOL_ORIGIN)),
    ("joystick.led.wrist-origin", Joystick, BIT, |d| {
        Bits(&mut d.joystick_leds, joystick_frame::WRIST_ORIGIN)
    }),
    ("table.number", Table, NUMBER, |d| Long(&mut d.pedestal_table.number)),
    ("table.order", Table, ORDER, |d| Order(&mut d.pedestal_table.order)),
    ("table.steps", Table, COUNT, |d| Count(&mut d.pedestal_table.steps)),
];

impl Output {
    /// The output of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|output| output.name() == name)
    }

    /// All outputs.
    pub fn all() -> impl Iterator<Item = Self> {
        OUTPUTS.iter().map(Self)
    }

    /// The outputs that drive air valves.
    pub fn valves() -> impl Iterator<Item = Self> {
        Self::all().filter(|output| !matches!(output.group(), Joystick | Table))
    }

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.0.0
    }

    /// The group of its devices.
    #[must_use]
    pub const fn group(self) -> Group {
        self.0.1
    }

    /// Permitted values.
    #[must_use]
    pub const fn range(self) -> RangeInclusive<i64> {
        RangeInclusive::new(*self.0.2.start(), *self.0.2.end())
    }

    /// Its present value.
    #[must_use]
    pub fn read(self, outputs: &DeviceOutputs) -> i64 {
        let mut copy = *outputs;
        (self.0.3)(&mut copy).read()
    }

    /// Set it to the nearest permitted value.
    pub fn write(self, outputs: &mut DeviceOutputs, value: i64) {
        let range = self.range();
        (self.0.3)(outputs).write(value.clamp(*range.start(), *range.end()));
    }
}

impl PartialEq for Output {
    fn eq(&self, other: &Self) -> bool {
        core::ptr::eq(self.0, other.0)
    }
}

impl Eq for Output {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_output_has_its_own_word() {
        let mut all = DeviceOutputs::default();
        for output in Output::all() {
            assert_eq!(Output::named(output.name()), Some(output));
            let most = *output.range().end();
            let mut outputs = DeviceOutputs::default();
            output.write(&mut outputs, most);
            assert_eq!(output.read(&outputs), most, "{}", output.name());
            output.write(&mut outputs, 0);
            assert_eq!(outputs, DeviceOutputs::default(), "{}", output.name());
            let before = all;
            output.write(&mut all, most);
            assert_ne!(all, before, "{} has the word of another output", output.name());
        }
        assert_eq!(Output::valves().count(), 23);
    }
}
