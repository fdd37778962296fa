//! Conversions between the manual's integers and the controller's inches and radians. No other module converts them
//! (docs/design/units.md "Manual").

use core::f64::consts::PI;

/// Hundredths of an inch per inch (VII.1).
const PER_INCH: f64 = 100.0;
/// Hundredths of a degree per half turn (VII.2).
const PER_HALF_TURN: f64 = 18_000.0;

/// Inches from hundredths of an inch.
#[must_use]
#[inline]
pub fn inches(hundredths: i32) -> f64 {
    f64::from(hundredths) / PER_INCH
}

/// Hundredths of an inch from inches, rounded to the nearest (halves away from zero), saturating.
#[must_use]
#[inline]
pub fn hundredths(inches: f64) -> i32 {
    rounded(inches * PER_INCH)
}

/// Radians from hundredths of a degree.
#[must_use]
#[inline]
pub fn radians(hundredths_of_degree: i32) -> f64 {
    f64::from(hundredths_of_degree) * (PI / PER_HALF_TURN)
}

/// Hundredths of a degree from radians, rounded to the nearest, saturating.
#[must_use]
#[inline]
pub fn hundredths_of_degree(radians: f64) -> i32 {
    rounded(radians * (PER_HALF_TURN / PI))
}

/// The nearest integer (halves away from zero); saturates, and NaN gives 0.
#[must_use]
#[expect(
    clippy::as_conversions,
    reason = "a float-to-integer cast saturates and takes NaN to 0, which is what is wanted"
)]
#[inline]
pub fn rounded(value: f64) -> i32 {
    libm::round(value) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_to_the_nearest_and_saturates() {
        assert_eq!(hundredths(-14.835), -1484);
        assert_eq!(hundredths(0.625), 63);
        assert_eq!(hundredths(1e12), i32::MAX);
        assert_eq!(hundredths(f64::NAN), 0);
        assert_eq!(hundredths_of_degree(PI), 18_000);
        assert!((radians(-300) + 0.052_359_877).abs() < 1e-8);
    }
}
