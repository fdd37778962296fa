//! Random numbers from a seed: PCG-XSH-RR 64/32 (O'Neill, 2014). Local, so that every build gives the same faults.

use rcs_core::Plain;

const MULTIPLIER: u64 = 6_364_136_223_846_793_005;

/// The generator.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Numbers {
    state: u64,
    stream: u64,
}

impl Numbers {
    /// A generator; different streams of the same seed are independent.
    #[must_use]
    pub const fn new(seed: u64, stream: u64) -> Self {
        let stream = stream.wrapping_shl(1) | 1;
        let state = stream.wrapping_add(seed).wrapping_mul(MULTIPLIER).wrapping_add(stream);
        Self { state, stream }
    }

    /// The next number, uniform over all 32-bit numbers.
    pub fn draw(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(MULTIPLIER).wrapping_add(self.stream);
        let mixed = ((old.wrapping_shr(18) ^ old).wrapping_shr(27) & u64::from(u32::MAX)).to_le_bytes();
        let [a, b, c, d, ..] = mixed;
        let turn = u32::try_from(old.wrapping_shr(59)).unwrap_or_default();
        u32::from_le_bytes([a, b, c, d]).rotate_right(turn)
    }

    /// A uniform number from 0 to `end` - 1; 0 if `end` is 0.
    pub fn below(&mut self, end: u32) -> u32 {
        let scaled = u64::from(self.draw()).wrapping_mul(u64::from(end)).wrapping_shr(32);
        u32::try_from(scaled).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_numbers_are_those_of_the_published_generator() {
        let mut numbers = Numbers::new(42, 54); // `pcg32-demo` of the author's library: seed 42, stream 54
        let drawn: Vec<u32> = (0..6).map(|_| numbers.draw()).collect();
        assert_eq!(drawn, [0xA15C_02B7, 0x7B47_F409, 0xBA1D_3330, 0x83D2_F293, 0xBFA4_784B, 0xCBED_606E]);
    }

    #[test]
    fn below_stays_below() {
        let mut numbers = Numbers::new(1, 1);
        let mut seen = [0_u32; 7];
        for _ in 0..7000 {
            seen[numbers.below(7) as usize] += 1;
        }
        assert!(seen.iter().all(|count| (850..1150).contains(count)), "{seen:?}");
        assert_eq!(numbers.below(0), 0);
    }
}
