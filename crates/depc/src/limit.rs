//! The velocity limits of the controller (A 2.3): 14 in/s and 1.0 rad/s.
//!
//! The controller sees only words, so the limits apply to the step between two sets of words: the distance of the end
//! plate, and D, E and R separately (ASSUMED; the appendix says "the commanded change in translation or orientation").
//! Both ends use the same integers, so each accepts exactly the steps that the other permits.

use core::fmt;

use rcs_core::Plain;

use crate::{Error, Plate, plate::angle_between};

/// 14 in/s = 0.0014 counts of 0.01 in per microsecond, in ten-thousandths of a count.
const TRANSLATION_PER_US: u64 = 14;
const TRANSLATION_UNIT_SQUARED: u64 = 10_000 * 10_000; // ten-thousandths of a count, squared
/// 1 rad/s = 0.00572957795 counts of 0.01 degree per microsecond, in 1e-11 of a count.
const ORIENTATION_PER_US: u64 = 572_957_795;
const ORIENTATION_UNIT: u64 = 100_000_000_000; // 1e11

/// The limits for one period of the link.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Limits {
    /// Time within which a data command must be reached, microseconds.
    period_us: u32,
}

/// The limit that a step exceeds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exceeded {
    /// The end plate would move too far: warning D3.
    Translation,
    /// D, E or R would change too much: warning D4.
    Orientation,
}

impl fmt::Display for Exceeded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Translation => "more than 14 in/s of the end plate",
            Self::Orientation => "more than 1.0 rad/s in D, E or R",
        })
    }
}

impl Limits {
    /// The period that NBS configured (VI.1): 40 ms; 0.56 in and 2.29 degrees.
    pub const NBS: Self = Self { period_us: 40_000 };

    /// The period of the appendix (A 2.3): 19.76 ms; 0.27 in and 1.13 degrees.
    pub const APPENDIX: Self = Self { period_us: 19_760 };

    /// Limits for a period in ms: a multiple of 10 from 10 to 1000 (VI.1), else [`Error::BadPeriod`].
    pub const fn new(period_ms: u16) -> Result<Self, Error> {
        if period_ms == 0 || period_ms > 1000 || !period_ms.is_multiple_of(10) {
            return Err(Error::BadPeriod { milliseconds: period_ms });
        }
        let [low, high] = period_ms.to_le_bytes();
        Ok(Self { period_us: u32::from_le_bytes([low, high, 0, 0]).saturating_mul(1000) })
    }

    /// The period, microseconds.
    #[must_use]
    pub const fn period_us(&self) -> u32 {
        self.period_us
    }

    /// The period, milliseconds, rounded up.
    #[must_use]
    pub fn period_ms(&self) -> u16 {
        u16::try_from(self.period_us.div_ceil(1000)).unwrap_or(u16::MAX)
    }

    /// The longest step of the end plate per period, squared, in (0.01 in)².
    #[must_use]
    pub fn translation_squared(&self) -> u64 {
        let way = TRANSLATION_PER_US.saturating_mul(u64::from(self.period_us));
        way.saturating_mul(way).checked_div(TRANSLATION_UNIT_SQUARED).unwrap_or_default()
    }

    /// The largest change of D, E or R per period, 0.01 degree.
    #[must_use]
    pub fn orientation(&self) -> i32 {
        let scaled = ORIENTATION_PER_US.saturating_mul(u64::from(self.period_us));
        i32::try_from(scaled.checked_div(ORIENTATION_UNIT).unwrap_or_default()).unwrap_or(i32::MAX)
    }

    /// Checks that the controller accepts a step. Errors: the exceeded limit, translation first.
    pub fn check(&self, from: &Plate, to: &Plate) -> Result<(), Exceeded> {
        let ([x, y, z, d, e, r], [to_x, to_y, to_z, to_d, to_e, to_r]) = (from.words, to.words);
        let squared: u64 = [(x, to_x), (y, to_y), (z, to_z)]
            .iter()
            .map(|(a, b)| u64::from(a.abs_diff(*b)))
            .map(|way| way.saturating_mul(way))
            .fold(0, u64::saturating_add);
        if squared > self.translation_squared() {
            return Err(Exceeded::Translation);
        }
        let too_much = |(a, b): &(i16, i16)| angle_between(*a, *b).saturating_abs() > self.orientation();
        if [(d, to_d), (e, to_e), (r, to_r)].iter().any(too_much) {
            return Err(Exceeded::Orientation);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOME: Plate = Plate { words: [0, -6296, -635, -9000, 13495, 0] };

    fn moved(by: [i16; 6]) -> Plate {
        let mut words = HOME.words;
        for (word, by) in words.iter_mut().zip(by) {
            *word += by;
        }
        Plate { words }
    }

    #[test]
    fn limits_are_those_of_the_period() {
        assert_eq!((Limits::NBS.translation_squared(), Limits::NBS.orientation()), (56 * 56, 229));
        let ten = Limits::new(10).unwrap();
        assert_eq!((ten.translation_squared(), ten.orientation()), (14 * 14, 57));
        let slowest = Limits::new(1000).unwrap();
        assert_eq!((slowest.translation_squared(), slowest.orientation()), (1400 * 1400, 5729));
        // 0.27664 in and 1.1321 degrees.
        assert_eq!((Limits::APPENDIX.translation_squared(), Limits::APPENDIX.orientation()), (765, 113));
        assert_eq!((Limits::APPENDIX.period_us(), Limits::APPENDIX.period_ms()), (19_760, 20));
        assert_eq!((ten.period_us(), ten.period_ms()), (10_000, 10));
        for bad in [0, 5, 45, 1010] {
            assert_eq!(Limits::new(bad), Err(Error::BadPeriod { milliseconds: bad }));
        }
    }

    #[test]
    fn the_last_count_is_allowed_and_the_next_is_not() {
        let check = |by| Limits::NBS.check(&HOME, &moved(by));
        assert_eq!(check([56, 0, 0, 229, -229, 229]), Ok(()));
        assert_eq!(check([0, 57, 0, 0, 0, 0]), Err(Exceeded::Translation));
        assert_eq!(check([40, 40, 0, 0, 0, 0]), Err(Exceeded::Translation));
        assert_eq!(check([32, -32, 32, 0, 0, 0]), Ok(()));
        for place in 3..6 {
            let mut by = [0; 6];
            by[place] = -230;
            assert_eq!(check(by), Err(Exceeded::Orientation));
        }
    }

    #[test]
    fn a_whole_turn_is_not_a_change() {
        let a = Plate { words: [0, 0, 0, 18_000, 9_000, -17_950] };
        let b = Plate { words: [0, 0, 0, -18_000, 9_000, 18_000] };
        assert_eq!(Limits::NBS.check(&a, &b), Ok(()));
    }
}
