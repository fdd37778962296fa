//! A joint resolver: 17 bits per turn, 0 at angle 0 (III.3.2).

use interfaces::device::RESOLVER_COUNTS;

use crate::noise::Noise;

/// Counts at an angle in radians, with noise of up to `greatest` counts. It draws no number if `greatest` is 0.
pub fn counts(angle: f64, greatest: f64, noise: &mut Noise) -> u32 {
    let turns = angle / (2.0 * core::f64::consts::PI);
    let away = if greatest > 0.0 { noise.within(greatest) } else { 0.0 };
    let turn = f64::from(RESOLVER_COUNTS);
    let counts = libm::round((turns - libm::floor(turns)) * turn + away);
    ((counts + turn) as u32) % RESOLVER_COUNTS
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Stream;

    #[test]
    fn resolver_counts_up_from_zero_and_wraps() {
        let mut noise = Noise::new(1, Stream::Resolvers);
        let mut exact = |angle| counts(angle, 0.0, &mut noise);
        assert_eq!(exact(0.0), 0);
        assert_eq!(exact(core::f64::consts::PI), 65_536);
        assert_eq!(exact(-core::f64::consts::FRAC_PI_2), 98_304);
        assert_eq!(exact(-1e-9), 0, "rounded up to a whole turn");
    }

    #[test]
    fn resolver_noise_wraps() {
        let mut noise = Noise::new(1, Stream::Resolvers);
        let read: Vec<u32> = (0..100).map(|_| counts(0.0, 4.0, &mut noise)).collect();
        assert!(read.iter().all(|read| *read <= 4 || *read >= RESOLVER_COUNTS - 4));
        assert!(read.iter().any(|read| *read > 4), "below zero is the end of the turn");
    }
}
