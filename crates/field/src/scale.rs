//! Converts the words of a device to the value of a point, and back.

use std::ops::RangeInclusive;

use serde::Deserialize;

/// A raw value that is beyond the span of `raw` by more than this fraction of it means a broken wire.
const BROKEN: f64 = 0.03;

/// How a value is stored in the words of a device.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    Bit,
    #[default]
    U16,
    I16,
    U32,
    I32,
}

impl Format {
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Bit => "bit",
            Self::U16 => "u16",
            Self::I16 => "i16",
            Self::U32 => "u32",
            Self::I32 => "i32",
        }
    }

    #[must_use]
    pub const fn registers(self) -> u16 {
        match self {
            Self::Bit | Self::U16 | Self::I16 => 1,
            Self::U32 | Self::I32 => 2,
        }
    }

    #[must_use]
    pub const fn range(self) -> RangeInclusive<i64> {
        match self {
            Self::Bit => 0..=1,
            Self::U16 => 0..=0xFFFF,
            Self::I16 => -0x8000..=0x7FFF,
            Self::U32 => 0..=0xFFFF_FFFF,
            Self::I32 => -0x8000_0000..=0x7FFF_FFFF,
        }
    }
}

/// A straight line through two points, from the raw value of a device to the counts of the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Raw values of the two points.
    pub raw: [f64; 2],
    /// Their counts.
    pub counts: [f64; 2],
}

impl Line {
    /// The counts of a raw value. The counts `ends` mean a broken wire: a raw value within the span never gives them,
    /// and one that is beyond the span by 3 % gives the nearer end.
    #[must_use]
    pub fn counts(&self, raw: i64, ends: Option<&RangeInclusive<i64>>) -> i64 {
        let part = (raw as f64 - self.raw[0]) / (self.raw[1] - self.raw[0]);
        let value = self.counts[0] + part * (self.counts[1] - self.counts[0]);
        let value = value.round() as i64;
        let Some(ends) = ends else { return value };
        let (least, most) = (*ends.start(), *ends.end());
        let rising = self.counts[1] > self.counts[0];
        match part {
            part if part < -BROKEN => {
                if rising {
                    least
                } else {
                    most
                }
            }
            part if part > 1.0 + BROKEN => {
                if rising {
                    most
                } else {
                    least
                }
            }
            _ => value.clamp(least + 1, most - 1),
        }
    }

    /// The raw value that gives these counts.
    #[must_use]
    pub fn raw(&self, counts: i64) -> i64 {
        let part = (counts as f64 - self.counts[0]) / (self.counts[1] - self.counts[0]);
        (self.raw[0] + part * (self.raw[1] - self.raw[0])).round() as i64
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const FULL: RangeInclusive<i64> = 0..=4095;
    const VOLTS: Line = Line { raw: [0.0, 32767.0], counts: [0.0, 4095.0] };
    const BRIDGE: Line = Line { raw: [-32768.0, 32767.0], counts: [0.0, 4095.0] };
    /// 4 to 20 mA on a channel that reads below 4 mA.
    const LOOP: Line = Line { raw: [6554.0, 32767.0], counts: [0.0, 4095.0] };

    #[test]
    fn raw_within_the_span_is_no_broken_wire() {
        assert_eq!([0, 1, 16384, 32767].map(|raw| VOLTS.counts(raw, Some(&FULL))), [1, 1, 2048, 4094]);
        assert_eq!(BRIDGE.counts(-32768, Some(&FULL)), 1);
    }

    #[test]
    fn raw_far_outside_the_span_is_a_broken_wire() {
        assert_eq!([0, 5000, 6000, 6554].map(|raw| LOOP.counts(raw, Some(&FULL))), [0, 0, 1, 1]);
        let falling = Line { counts: [4095.0, 0.0], ..LOOP };
        assert_eq!([0, 6000].map(|raw| falling.counts(raw, Some(&FULL))), [4095, 4094]);
    }

    proptest! {
        #[test]
        fn counts_survive_the_way_through_a_device(counts in 1_i64..4095) {
            for line in [VOLTS, BRIDGE, LOOP] {
                prop_assert_eq!(line.counts(line.raw(counts), Some(&FULL)), counts);
            }
        }

        #[test]
        fn counts_stay_in_range(raw in i64::from(i32::MIN)..i64::from(u32::MAX)) {
            for line in [VOLTS, BRIDGE, LOOP] {
                prop_assert!(FULL.contains(&line.counts(raw, Some(&FULL))));
            }
        }
    }
}
