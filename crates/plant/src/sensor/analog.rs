//! A sensor with a voltage on a 12-bit converter.

use interfaces::device::ADC_FULL_SCALE;

use crate::noise::Noise;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Analog {
    pub offset: f64, // at a value of 0
    pub scale: f64,  // per unit of the value
    pub noise: f64,  // counts
}

impl Analog {
    /// Counts for a value; the converter saturates at its limits.
    pub fn counts(&self, value: f64, noise: &mut Noise) -> u16 {
        let volts = self.offset + self.scale * value + noise.within(self.noise);
        libm::round(volts).clamp(0.0, f64::from(ADC_FULL_SCALE)) as u16
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Stream;

    #[test]
    fn sensor_is_linear_within_its_converter_range() {
        let analog = Analog { offset: 205.0, scale: 700.0, noise: 0.0 };
        let mut noise = Noise::new(1, Stream::Gripper);
        let counts = [-1.0, 0.0, 0.5, 1.0007, 5.0, 6.0].map(|value| analog.counts(value, &mut noise));
        assert_eq!(counts, [0, 205, 555, 905, 3705, ADC_FULL_SCALE]);
    }

    #[test]
    fn sensor_noise_is_unbiased_and_bounded() {
        let analog = Analog { offset: 1000.0, scale: 1.0, noise: 3.0 };
        let mut noise = Noise::new(1, Stream::Gripper);
        let read: Vec<f64> = (0..4000).map(|_| f64::from(analog.counts(0.0, &mut noise)) - 1000.0).collect();
        assert!(read.iter().all(|away| away.abs() <= 3.0));
        let mean = read.iter().sum::<f64>() / 4000.0;
        assert!(mean.abs() < 0.1, "{mean}");
    }
}
