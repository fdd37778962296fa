//! Seeded noise: one random stream per device, so that the numbers of a device do not depend on other devices.

use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stream {
    Gripper = 1,
    Camera = 2,
    Placement = 3,
    Force = 5,
    Pedestal = 4,
    Resolvers = 6,
    /// Errors of an operator who aligns the robot's axes to their arrows.
    Alignment = 20,
}

#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Noise(ChaCha8Rng);

impl Noise {
    #[must_use]
    pub fn new(seed: u64, stream: Stream) -> Self {
        Self::numbered(seed, stream as u64)
    }

    /// The stream for a seed with a number above those of the devices.
    #[must_use]
    pub fn numbered(seed: u64, stream: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(stream);
        Self(generator)
    }

    /// The next number, uniform in -greatest..greatest.
    pub fn within(&mut self, greatest: f64) -> f64 {
        let fraction = (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        greatest * (2.0 * fraction - 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_differ_and_repeat() {
        let draw = |seed, stream| {
            let mut noise = Noise::new(seed, stream);
            (0..8).map(|_| noise.within(1.0)).collect::<Vec<f64>>()
        };
        assert_eq!(draw(7, Stream::Camera), draw(7, Stream::Camera));
        assert_ne!(draw(7, Stream::Camera), draw(7, Stream::Gripper));
        assert_ne!(draw(7, Stream::Camera), draw(8, Stream::Camera));
        assert!(draw(7, Stream::Placement).iter().all(|v| v.abs() <= 1.0));
    }
}
